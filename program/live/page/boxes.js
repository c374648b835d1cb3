// The table `boxes` of a camera, drawn on its colour: the box of the visible pixels of an object in the colour that its
// id has in the image of ids; of an object that is hidden, the whole box, dashed.
import { colorOfLabel } from "simvis/color_ramp.js";

const SVG = "http://www.w3.org/2000/svg";
const VIEWS = ["left", "right"]; // of a stereo camera, by the column `view`
const SIDES = ["x_min", "y_min", "x_max", "y_max"];

/** Whether a table, as a frame has it, is one of boxes. */
export const hasBoxes = ({ columns }) => columns.some(([name]) => name === "visible_x_min");

/** The boxes of one view: id, sides in pixels from the picture's corner, and whether anything of the object is visible. */
function boxesOf({ columns, rows }, view) {
  const place = new Map(columns.map(([name], column) => [name, column]));
  return rows
    .filter((row) => !place.has("view") || VIEWS[row[place.get("view")]] === view)
    .map((row) => {
      const visible = row[place.get("visible_pixels")] > 0,
        kind = visible ? "visible" : "full";
      return { id: row[place.get("object")], sides: SIDES.map((side) => row[place.get(`${kind}_${side}`)]), visible };
    });
}

/** An overlay of a picture of this size. `view` is the name of the image of colour. */
export function drawBoxes(overlay, [width, height], table, view) {
  overlay.setAttribute("viewBox", `0 0 ${width} ${height}`);
  overlay.replaceChildren(
    ...boxesOf(table, view).map(({ id, sides: [left, top, right, bottom], visible }) => {
      const rect = document.createElementNS(SVG, "rect"),
        all = { x: left, y: top, width: right - left, height: bottom - top, stroke: `rgb(${colorOfLabel(id)})` };
      for (const [name, value] of Object.entries(all)) rect.setAttribute(name, value);
      rect.dataset.object = id;
      if (!visible) rect.setAttribute("stroke-dasharray", "4 4");
      return rect;
    }),
  );
}

export function boxOverlay() {
  const overlay = document.createElementNS(SVG, "svg");
  overlay.setAttribute("aria-hidden", "true"); // the table says the same
  return overlay;
}
