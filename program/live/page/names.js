// What the ids of items and classes stand for, in the images and scans that have them.

/** Whether the numbers of an output name things, so that near ones have nothing in common. */
export const isId = (output) => /(^|_)(instance|semantic|object|item|primitive|ring)$/.test(output);

export class Names {
  constructor() {
    this.setItems([]);
  }

  /** `items`: [part, mesh, instance, semantic, label] of each item of the draw list. */
  setItems(items) {
    this.items = items;
    this.instances = new Map(
      items.map(([part, mesh, instance]) => [instance, mesh && mesh !== part ? `${part} ${mesh}` : part]),
    );
    this.classes = new Map(
      items.filter(([, , , semantic]) => semantic > 0).map(([, , , semantic, label]) => [semantic, label]),
    );
  }

  /** The name of a number of an output; empty if it has none. */
  of(output, value) {
    if (output.endsWith("instance") || output.endsWith("object")) return this.instances.get(value) ?? "";
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
