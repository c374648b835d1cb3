// The tree of parts, models, links, elements and sensors. Keyboard as WAI-ARIA has it for trees.

/** Nodes { kind, name, what, children } of the list that `simvis-run --list --json` prints, and of Objects. */
export function nodesOf(list, objects) {
  const nodes = list.parts.map((part) => ({
    kind: "part",
    name: part.name,
    what: part.source === part.name ? "" : part.source,
    children: [],
  }));
  const owner = new Map();
  list.parts.forEach((part, i) => {
    owner.set(part.name, nodes[i]);
    for (const point of part.insertion_points) if (!owner.has(point)) owner.set(point, nodes[i]);
  });
  const at = (point) => owner.get(point) ?? nodes[0];
  for (const object of objects.all) {
    if (object.kind === "part" || object.kind === "shape") continue;
    const above = objects.parentOf(object);
    if (!objects.listed.has(object)) {
      owner.set(object.name, at(above?.name));
      continue;
    }
    const node = { kind: object.kind, name: object.name, what: object.label, children: [] };
    at(above?.name).children.push(node);
    owner.set(object.name, node);
  }
  for (const element of list.elements)
    at(element.insert_at).children.push({ kind: "element", name: element.name, what: element.type, children: [] });
  for (const sensor of list.sensors) {
    const what = sensor.attributes.view === "visualization" ? `${sensor.type} for people` : sensor.type;
    at(sensor.insert_at).children.push({ kind: "sensor", name: sensor.name, what, children: [] });
  }
  list.parts.forEach((part, i) => {
    if (i > 0) at(part.insert_at).children.push(nodes[i]);
  });
  return nodes.slice(0, 1);
}

export class Tree {
  constructor(root, filter, onSelect) {
    this.root = root;
    this.onSelect = onSelect;
    this.folded = new Set();
    this.selected = null; // { kind, name }
    this.filter = filter;
    filter.addEventListener("input", () => this.draw());
    root.addEventListener("keydown", (event) => this.press(event));
    root.addEventListener("click", (event) => this.click(event));
  }

  show(list, objects) {
    this.top = nodesOf(list, objects);
    this.draw();
  }

  select(thing) {
    this.selected = thing;
    this.root.querySelector('[aria-selected="true"]')?.setAttribute("aria-selected", "false");
    if (!thing) return;
    const row = this.rows?.get(`${thing.kind} ${thing.name}`);
    row?.setAttribute("aria-selected", "true");
    row?.scrollIntoView({ block: "nearest" });
  }

  draw() {
    if (!this.top) return;
    const focused = this.root.contains(document.activeElement) ? document.activeElement.dataset.key : null;
    const rows = [],
      wanted = this.filter.value.trim().toLowerCase();
    const add = (node, depth) => {
      const key = `${node.kind} ${node.name}`,
        open = !this.folded.has(key) || wanted !== "";
      const before = rows.length;
      rows.push(this.row(node, key, depth, open));
      if (open) for (const child of node.children) add(child, depth + 1);
      const matches = wanted === "" || `${node.name} ${node.what}`.toLowerCase().includes(wanted);
      if (!matches && rows.length === before + 1) rows.pop();
    };
    for (const node of this.top) add(node, 0);
    this.root.replaceChildren(...rows);
    this.rows = new Map(rows.map((row) => [row.dataset.key, row]));
    const current =
      rows.find((row) => row.dataset.key === focused) ?? rows.find((row) => row.ariaSelected === "true") ?? rows[0];
    if (current) current.tabIndex = 0;
    if (focused && current) current.focus();
  }

  row(node, key, depth, open) {
    const row = document.createElement("div");
    row.setAttribute("role", "treeitem");
    row.setAttribute("aria-level", depth + 1);
    row.setAttribute("aria-selected", String(this.selected?.kind === node.kind && this.selected?.name === node.name));
    if (node.children.length > 0) row.setAttribute("aria-expanded", String(open));
    row.tabIndex = -1;
    row.dataset.key = key;
    row.dataset.kind = node.kind;
    row.dataset.name = node.name;
    row.style.paddingLeft = `${4 + 12 * depth}px`;
    const part = (name, text) => {
      const span = document.createElement("span");
      span.className = name;
      span.textContent = text;
      return span;
    };
    row.append(
      part("fold", node.children.length === 0 ? "" : open ? "▾" : "▸"),
      part(`dot ${node.kind}`, ""),
      part("name", node.name),
      part("what", node.what),
    );
    row.title = `${node.kind} ${node.name}${node.what ? ` (${node.what})` : ""}`;
    return row;
  }

  click(event) {
    const row = event.target.closest('[role="treeitem"]');
    if (!row) return;
    if (event.target.classList.contains("fold")) return this.fold(row, row.ariaExpanded === "true");
    row.focus();
    this.onSelect({ kind: row.dataset.kind, name: row.dataset.name });
  }

  fold(row, close) {
    if (close) this.folded.add(row.dataset.key);
    else this.folded.delete(row.dataset.key);
    this.draw();
  }

  press(event) {
    const row = event.target.closest('[role="treeitem"]');
    if (!row) return;
    const rows = [...this.root.children],
      at = rows.indexOf(row);
    const level = Number(row.getAttribute("aria-level")),
      expanded = row.getAttribute("aria-expanded");
    const go = (target) => {
      if (target) {
        row.tabIndex = -1;
        target.tabIndex = 0;
        target.focus();
      }
    };
    const keys = {
      ArrowDown: () => go(rows[at + 1]),
      ArrowUp: () => go(rows[at - 1]),
      Home: () => go(rows[0]),
      End: () => go(rows[rows.length - 1]),
      ArrowRight: () => (expanded === "false" ? this.fold(row, false) : expanded === "true" && go(rows[at + 1])),
      ArrowLeft: () =>
        expanded === "true"
          ? this.fold(row, true)
          : go(
              rows
                .slice(0, at)
                .reverse()
                .find((each) => Number(each.getAttribute("aria-level")) < level),
            ),
      Enter: () => this.onSelect({ kind: row.dataset.kind, name: row.dataset.name }),
      " ": () => this.onSelect({ kind: row.dataset.kind, name: row.dataset.name }),
    };
    if (!keys[event.key]) return;
    keys[event.key]();
    event.preventDefault();
    event.stopPropagation();
  }
}
