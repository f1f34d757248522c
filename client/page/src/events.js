// What happened, newest first.
import { byId, make } from "./dom.js";
import { runTime } from "./text.js";

const kMost = 200;
const kSigns = { info: ["", ""], warning: ["⚠", "Warning"], error: ["✕", "Error"] };

export class Events {
  constructor() {
    this.list = byId("event-list");
  }

  add({ time_s, track, level, text }, tracks) {
    const [sign, word] = kSigns[level] ?? kSigns.info;
    const item = make("li", { className: `event ${level}` },
      make("time", {}, Number.isFinite(time_s) ? runTime(time_s) : ""),
      make("span", { className: "sign", title: word, role: word ? "img" : "presentation", "aria-label": word }, sign),
      make("span", {}, tracks > 1 && Number.isFinite(track) ? `${"AB"[track]}: ${text}` : text));
    this.list.prepend(item);
    while (this.list.children.length > kMost) this.list.lastChild.remove();
    byId("no-events").hidden = true;
  }
}

/** A line that goes away by itself; for what was refused. */
export function say(text) {
  const toast = byId("toast");
  toast.textContent = text;
  toast.hidden = false;
  window.clearTimeout(say.hiding);
  say.hiding = window.setTimeout(() => (toast.hidden = true), 9000);
}
