// The objects of the scene: parts, and the models, links and named places in their files.

export class Objects {
  /** `rows`: [name, path, kind, instance, parent, class, label] of each object, parents in front of what belongs to them;
   * `items` of the draw list begin with the name of the object in front of which they stand. */
  constructor(rows = [], items = []) {
    this.all = rows.map(([name, path, kind, instance, parent, semantic, label]) => ({
      name,
      path,
      kind,
      instance,
      parent,
      semantic,
      label,
    }));
    this.byName = new Map(this.all.map((object) => [object.name, object]));
    this.byInstance = new Map(this.all.map((object) => [object.instance, object]));
    this.shownIds = new Map(items.map(([point, , instance]) => [point, instance]));
    const drawn = this.shownIds;
    this.listed = new Set(
      this.all.filter(({ kind, name }) => kind === "model" || kind === "link" || (kind === "frame" && drawn.has(name))),
    );
  }

  parentOf(object) {
    return this.byInstance.get(object.parent) ?? null;
  }

  /** The object of this name that the tree lists besides parts, or the nearest one that it belongs to; null: a part. */
  listedAt(name) {
    let object = this.byName.get(name) ?? null;
    while (object && !this.listed.has(object)) object = object.kind === "part" ? null : this.parentOf(object);
    return object;
  }

  /** The id that its surfaces show: of an object that a label makes one with others, that of the whole. */
  idOf(object) {
    return this.shownIds.get(object.name) ?? object.instance;
  }

  /** The part whose file has the object; null: none. */
  partOf(object) {
    while (object && object.kind !== "part") object = this.parentOf(object);
    return object;
  }

  /** The names of the object and of what belongs to it in its file. */
  contentOf(name) {
    const names = new Set([name]);
    for (const object of this.all)
      if (object.kind !== "part" && names.has(this.parentOf(object)?.name)) names.add(object.name);
    return names;
  }
}
