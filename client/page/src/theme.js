// Colours, from the style sheet: one place says them for light and dark.

const names = [
  "view-back", "floor", "solid", "solid-edge", "soft", "grid", "track-0", "track-1", "asked", "applied", "axis-x", "axis-y",
  "axis-z", "text", "faint", "line", "good", "bad", "unknown", "plane", "hand",
  "robot", "robot-joint", "exerted",
];

/** The colours of now, by the name of their variable; the same object is filled anew when the theme changes. */
export const colours = {};

const listeners = [];

function read() {
  const style = getComputedStyle(document.documentElement);
  for (const name of names) colours[name] = style.getPropertyValue(`--${name}`).trim();
}

/** Calls `then` after each change between light and dark. */
export function onTheme(then) {
  listeners.push(then);
}

export function watchTheme() {
  read();
  window.matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => {
    read();
    for (const then of listeners) then();
  });
}

/** Whether the person asked for less motion. Asked each time: the setting may change. */
const motion = window.matchMedia("(prefers-reduced-motion: reduce)");
export function lessMotion() {
  return motion.matches;
}
