// What the colours of scans mean.
import { NO_WHOLE, colorOfLabel, rampCss, short } from "simvis/color_ramp.js";

const MOST_LABELS = 12;

/** The ends of the ramp. */
export function showRamp(root, [low, high], unit) {
  root.innerHTML = '<div class="ramp"></div><div class="scale"><span></span><span></span></div>';
  root.firstChild.style.background = rampCss();
  const ends = root.querySelectorAll("span");
  ends[0].textContent = `${short(low)} ${unit}`;
  ends[1].textContent = `${short(high)} ${unit}`;
}

/** The most frequent whole numbers, with their colours and what `nameOf` says of them. */
export function showLabels(root, numbers, nameOf) {
  const counts = new Map();
  for (const number of numbers) if (number !== NO_WHOLE) counts.set(number, (counts.get(number) ?? 0) + 1);
  const most = [...counts].sort((a, b) => b[1] - a[1]).slice(0, MOST_LABELS);
  root.replaceChildren(
    ...most.map(([number]) => {
      const line = document.createElement("div"),
        color = document.createElement("i");
      line.className = "label";
      color.style.background = `rgb(${colorOfLabel(number).map(Math.round)})`;
      line.append(color, `${number} ${nameOf(number)}`.trim());
      return line;
    }),
  );
}
