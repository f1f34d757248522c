// Small helpers for the document.

/** @returns {HTMLElement} the element of index.html with this id */
export function byId(id) {
  const found = document.getElementById(id);
  if (!found) throw new Error(`index.html has no element '${id}'`);
  return found;
}

/**
 * A new element. Properties that start with "aria-" or are named "role" or "for" become attributes.
 * @param {string} tag
 * @param {Object<string, unknown>} properties
 * @param {...(Node|string)} children
 * @returns {HTMLElement}
 */
export function make(tag, properties = {}, ...children) {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(properties)) {
    if (name.startsWith("aria-") || name === "role" || name === "for") made.setAttribute(name, String(value));
    else made[name] = value;
  }
  made.append(...children);
  return made;
}

/** Sets the text only where it differs: the browser lays out nothing that stays as it is. */
export function setText(element, text) {
  if (element.textContent !== text) element.textContent = text;
}

/** Fits a canvas to its size on the screen. @returns {number} pixels of the canvas for one of CSS */
export function fitCanvas(canvas) {
  const ratio = Math.min(window.devicePixelRatio || 1, 2);
  const width = Math.round(canvas.clientWidth * ratio);
  const height = Math.round(canvas.clientHeight * ratio);
  if (canvas.width !== width || canvas.height !== height) {
    canvas.width = width;
    canvas.height = height;
  }
  return ratio;
}

/**
 * A font for a canvas, in whole pixels: uPlot reads no others, and draws what follows the point.
 * @param {number} ofText share of the document's size of text @param {number} ratio pixels of the canvas for one of CSS
 */
export function canvasFont(ofText, ratio = 1) {
  const size_px = Math.round(ofText * parseFloat(getComputedStyle(document.documentElement).fontSize) * ratio);
  return { size_px, font: `${size_px}px system-ui, "DejaVu Sans", sans-serif` };
}

/** Calls `then` when the element's size on the screen changes. */
export function onResize(element, then) {
  new ResizeObserver(() => then()).observe(element);
}
