// A new sensor: its kind and name from a form, its place by dragging, and the line of XML that makes it.

const EXTRA = {
  camera: 'width="640" height="480" hfov="60"',
  stereo_camera: 'width="640" height="480" hfov="60"',
  laser_scanner: 'samples="361" min_angle="-90" max_angle="90"',
};
const START = { x: 0, y: 0, z: 0.5, roll: 0, pitch: 0, yaw: 0 };
const escaped = (text) => text.replace(/[&<>"]/g, (letter) => `&#${letter.charCodeAt(0)};`);
const rounded = (value) => String(Number(value.toFixed(4)) + 0);

export class PlaceSensor {
  constructor(form, { dragging, rowsOfPoint, execute, canExecute }) {
    this.form = form;
    this.pose = START;
    form.innerHTML = `<label>Type <select name="type">${Object.keys(EXTRA)
      .map((type) => `<option>${type}</option>`)
      .join("")}</select></label>
      <label>Name <input name="name" type="text" value="NEW_SENSOR" spellcheck="false"></label>
      <label>Insert at <select name="point"></select></label>
      <div class="row"><button type="button" name="drag" aria-pressed="false">Drag it in the view</button>
      <button type="button" name="turn" aria-pressed="false">Turn</button></div>
      <p class="weak">This line goes into the scene file:</p><code tabindex="0"></code>
      <div class="row"><button type="button" name="copy">Copy</button><button type="submit" class="strong">Insert now</button></div>`;
    this.fields = form.elements;
    const button = (name) => form.querySelector(`[name="${name}"]`);
    form.querySelector('[type="submit"]').hidden = !canExecute;
    form.addEventListener("input", () => this.write());
    form.addEventListener("submit", (event) => {
      event.preventDefault();
      execute(this.xml());
    });
    button("copy").addEventListener("click", () => navigator.clipboard?.writeText(this.xml()));
    button("turn").addEventListener("click", () => {
      const on = button("turn").ariaPressed !== "true";
      button("turn").ariaPressed = String(on);
      dragging.set(on ? "rotate" : "translate");
    });
    button("drag").addEventListener("click", () => {
      const on = button("drag").ariaPressed !== "true",
        rows = rowsOfPoint(this.fields.point.value);
      button("drag").ariaPressed = String(on);
      if (!on || !rows) return dragging.end();
      dragging.begin(rows, this.pose, (pose) => {
        this.pose = pose;
        this.write();
      });
    });
    this.write();
  }

  /** Somebody else drags now. */
  stop() {
    this.form.querySelector('[name="drag"]').ariaPressed = "false";
  }

  offer(points, chosen) {
    const select = this.fields.point,
      before = chosen ?? select.value;
    select.replaceChildren(...points.map((point) => new Option(point, point)));
    if (points.includes(before)) select.value = before;
    this.write();
  }

  xml() {
    const { x, y, z, roll, pitch, yaw } = this.pose,
      type = this.fields.type.value;
    return (
      `<sensor type="${type}" name="${escaped(this.fields.name.value)}" insert_at="${escaped(this.fields.point.value)}" ` +
      `pose_offset="${[x, y, z, roll, pitch, yaw].map(rounded).join(" ")}" ${EXTRA[type]}/>`
    );
  }

  write() {
    this.form.querySelector("code").textContent = this.xml();
  }
}
