// What the ids of objects, shapes and classes stand for, in the images and scans that have them.

/** Whether the numbers of an output name objects, so that near ones have nothing in common. */
export const isId = (output) => /(^|_)(instance|semantic|shape|object|item|primitive|ring)$/.test(output);

export class Names {
  constructor() {
    this.set([], []);
  }

  /** `items`: [point, mesh, instance, semantic, label, shape] of each item of the draw list; `objects` as those of Objects. */
  set(items, objects) {
    this.items = items;
    this.objects = new Map(objects.map(([, path, , instance]) => [instance, path]));
    this.shapes = new Map(
      items.map(([point, mesh, , , , shape]) => [shape, mesh && mesh !== point ? `${point} ${mesh}` : point]),
    );
    this.classes = new Map(
      items.filter(([, , , semantic]) => semantic > 0).map(([, , , semantic, label]) => [semantic, label]),
    );
  }

  /** The name of a number of an output; empty if it has none. */
  of(output, value) {
    if (output.endsWith("instance") || output.endsWith("object")) return this.objects.get(value) ?? "";
    if (output.endsWith("shape")) return this.shapes.get(value) ?? "";
    return output.endsWith("semantic") ? (this.classes.get(value) ?? "") : "";
  }

  /** The label of an item, by its place in the draw list. */
  labelOf(item) {
    return this.items[item]?.[4] ?? "";
  }

  meshOf(item) {
    return this.items[item]?.[1] ?? "";
  }
}
