// The plan of a frame, which is an indented text, as a tree that folds.

export function planNodes(text) {
  const root = { children: [] },
    path = [{ indent: -1, node: root }];
  for (const line of text.split("\n")) {
    if (line.trim() === "") continue;
    const indent = line.length - line.trimStart().length,
      node = { text: line.trim(), children: [] };
    while (path[path.length - 1].indent >= indent) path.pop();
    path[path.length - 1].node.children.push(node);
    path.push({ indent, node });
  }
  return root.children;
}

function listOf(nodes, open) {
  const list = document.createElement("ul");
  for (const { text, children } of nodes) {
    const item = document.createElement("li");
    if (children.length === 0) {
      item.textContent = text;
    } else {
      const details = document.createElement("details"),
        summary = document.createElement("summary");
      details.dataset.text = text;
      details.open = open.has(text);
      summary.textContent = text;
      details.append(summary, listOf(children, open));
      item.append(details);
    }
    list.append(item);
  }
  return list;
}

/** What is open stays open. */
export function showPlan(root, text) {
  const open = new Set([...root.querySelectorAll("details[open]")].map((details) => details.dataset.text));
  root.replaceChildren(listOf(planNodes(text), open));
}
