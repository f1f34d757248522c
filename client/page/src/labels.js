// Numbers beside the arrows of forces in the scene.
import { make, setText } from "./dom.js";
import { digits } from "./text.js";

const kLeast_N = 0.1; // less is noise of a sensor
const kAway_px = 14; // from the arrow's end

export class ForceLabels {
  /** @param {HTMLElement} area that the canvas fills */
  constructor(area) {
    this.area = area;
    this.labels = new Map(); // name -> element
  }

  /**
   * @param {string} name of the force, which its colour is called by
   * @param {number} force_N @param {{x: number, y: number}} begin, end of its arrow [pixels of the area]
   */
  show(name, force_N, begin, end) {
    const label = this.labels.get(name) ?? this.#add(name);
    label.hidden = !(force_N >= kLeast_N);
    if (label.hidden) return;
    setText(label, `${digits(force_N, 2)} N`);
    const length = Math.hypot(end.x - begin.x, end.y - begin.y) || 1;
    const x = end.x + (kAway_px * (end.x - begin.x)) / length;
    const y = end.y + (kAway_px * (end.y - begin.y)) / length;
    label.style.transform = `translate(${x.toFixed(0)}px, ${y.toFixed(0)}px) translate(-50%, -50%)`;
  }

  hide() {
    for (const label of this.labels.values()) label.hidden = true;
  }

  #add(name) {
    const label = make("span", { className: `force-label colour-${name}`, "aria-hidden": "true" });
    this.labels.set(name, label);
    this.area.append(label);
    return label;
  }
}
