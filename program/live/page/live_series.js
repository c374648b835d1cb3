// The series that graphs show of a running simulation, read from its messages. A recording has all series in one message.

export class LiveSeries {
  constructor(graphs) {
    this.graphs = graphs;
    this.changed = new Map(); // values of parameters since the last frame
  }

  /** `scene` is the one that is shown. */
  note(message, scene) {
    const notes = {
      scene: () => {
        this.graphs.clear();
        this.changed.clear();
      },
      values: () => message.values.forEach(([index, value]) => this.changed.set(index, value)),
      frame: () => this.noteFrame(message, scene),
    };
    notes[message.op]?.();
  }

  noteFrame({ time_s, tables }, { parameters, sensors }) {
    for (const [index, value] of this.changed) {
      const parameter = parameters[index];
      if (parameter) this.graphs.add(parameter.element, parameter.name, parameter.unit, true, time_s, value);
    }
    this.changed.clear();
    for (const { sensor, one_row, columns, rows } of tables) {
      if (!one_row || rows.length === 0) continue;
      columns.forEach(([column, unit], i) =>
        this.graphs.add(sensors[sensor].name, column, unit, false, time_s, rows[0][i] ?? NaN),
      );
    }
  }
}
