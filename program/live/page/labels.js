// The names of sensors beside their places in the view. The tree has all names, so these are for the eye only.
import * as THREE from "three";

const LETTER_PX = 7,
  LINE_PX = 15,
  ABOVE_PX = 8;

export class Labels {
  constructor(view, root) {
    Object.assign(this, { view, root, all: [], on: true });
    view.onDraw.push(() => this.place());
  }

  /** `places`: pairs of a name and a function that gives a point of the world, or null. */
  show(places) {
    this.all = places.map(([name, point]) => {
      const text = document.createElement("span");
      text.textContent = name;
      return { text, point, width: name.length * LETTER_PX };
    });
    this.root.replaceChildren(...this.all.map(({ text }) => text));
  }

  /** The nearest come first; a name that would lie over another one is left out. */
  place() {
    const { camera, canvas } = this.view,
      taken = [];
    const seen = this.all
      .map((label) => {
        const point = this.on && label.point();
        const place = point && new THREE.Vector3(...point).project(camera);
        return { ...label, place: place && Math.abs(place.z) < 1 ? place : null };
      })
      .sort((a, b) => (a.place?.z ?? 2) - (b.place?.z ?? 2));
    for (const { text, place, width } of seen) {
      const x = place && ((place.x + 1) / 2) * canvas.clientWidth,
        y = place && ((1 - place.y) / 2) * canvas.clientHeight - ABOVE_PX;
      const free = place && taken.every((other) => Math.abs(other.y - y) >= LINE_PX || Math.abs(other.x - x) >= (width + other.width) / 2);
      text.hidden = !free;
      if (!free) continue;
      taken.push({ x, y, width });
      text.style.transform = `translate(-50%, -100%) translate(${x.toFixed(1)}px, ${y.toFixed(1)}px)`;
    }
  }
}
