// What a word means: a "?" beside it, and the answer next to that.
import { byId, make, setText } from "./dom.js";

/** Heading and answer. */
const kTerms = {
  passivity: ["P, the true energy balance",
    "All energy that the device's damping and friction have taken since the start, less what its motors have given to the hand. " +
    "While it is 0 or above the device is passive, and no delay can have thrown the hand about. It is exact, and only of a simulated " +
    "device: of a real one nobody knows it."],
  ledger: ["The ledger",
    "The energy that the law may spend now. What the device's own damping takes from a motion is credited, what forces give back is " +
    "charged, and no force is applied that could cost more than is left."],
  place: ["The place the force is for",
    "A force takes its time to come. It was computed for where the tip was when its motion left: there is the ring. The farther it is " +
    "from the tip, the older is what the hand feels."],
  time: ["Where the time goes",
    "Of each force that reached the device, from the reading that it answers to the command: on the network in both directions, in the " +
    "server, waiting here for the next tick. The numbers are medians, each off by less than 0.05 %. Those of the parts need not add " +
    "up to the total's; none is above it. What was overtaken by a newer force is not in it, as it is in the round trip of all answers."],
};

/** A button that shows the answer for a term of this file. */
export function helpButton(term) {
  const [title] = kTerms[term];
  const button = make("button", { type: "button", className: "help", "aria-label": `What is this: ${title}?`, "aria-haspopup": "dialog" }, "?");
  button.addEventListener("click", () => show(button, term));
  return button;
}

function show(button, term) {
  const [title, answer] = kTerms[term];
  const panel = byId("help");
  setText(byId("help-title"), title);
  setText(byId("help-text"), answer);
  panel.showPopover();
  const at = button.getBoundingClientRect();
  const { width, height } = panel.getBoundingClientRect();
  const below = at.bottom + 6 + height <= window.innerHeight;
  panel.style.left = `${Math.max(8, Math.min(at.left, window.innerWidth - width - 8))}px`;
  panel.style.top = `${below ? at.bottom + 6 : Math.max(8, at.top - height - 6)}px`;
}

/** Puts a button into each element of the document that has `data-help`. */
export function placeHelp() {
  for (const place of document.querySelectorAll("[data-help]")) place.append(helpButton(place.dataset.help));
}
