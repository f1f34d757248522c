// The robot at the far end in numbers: what both ends do, how they are tied, and the robot's energy.
import { byId, make, setText } from "./dom.js";
import { digits } from "./text.js";

/** Of control/follower_state.hpp, by their numbers. */
export const kStates = ["none", "waiting", "following", "clutched", "holding", "stopping", "stopped", "failed",
  "taken"];

const kHints = {
  waiting: "keep the hand still for a moment, or press and release the device's button, and it follows",
  following: "its tool moves with the hand",
  clutched: "the robot holds its place while the hand moves elsewhere",
  holding: "the hand was not heard for 100 ms: it holds its place",
  stopping: "it is brought to rest",
  stopped: "it is at rest: move the hand and keep it still, or press and release the button",
  failed: "it refuses: the server's log says why",
  taken: "another device leads it, which took it while this one was silent",
};

const times = (value) => (value === undefined || value === null ? "–" : `× ${digits(value)}`);
const size = (values, axis) => Math.hypot(...["x", "y", "z"].map((name) => values[`${axis}_${name}_N`] ?? NaN));

/** Title, unit and text of each number. Lag: of the tool behind its target; drift: by how much the hand moved in pauses. */
const kRows = [
  ["Leader", "", ({ leader }) => leader ?? "–"],
  ["Robot", "", ({ state }) => state ?? "–"],
  ["Clutch", "", ({ state }) => (state === undefined ? "–" : state === "clutched" ? "pressed" : "released")],
  ["Architecture", "", ({ facts }) => facts.architecture ?? "–"],
  ["Its law", "", ({ facts }) => facts.law ?? "–"],
  ["Scales", "motion, force", ({ facts }) => `${times(facts.motion_scale)}, ${times(facts.force_scale)}`],
  ["Force on the hand", "N", ({ hand_N }) => digits(hand_N)],
  ["On its surroundings", "N", ({ values }) => digits(size(values, "force"))],
  ["Lag, drift", "mm", ({ values }) => `${digits(1e3 * values.lag_m)}, ${digits(1e3 * values.drift_m)}`],
  ["P, least", "mJ", ({ values }) => `${digits(1e3 * values.passivity_J)}, ${digits(1e3 * values.least_passivity_J)}`],
  ["Energy store", "mJ", ({ values, facts }) => `${digits(1e3 * values.store_J)} of ${digits(1e3 * facts.store_J)}`],
  ["From the hand", "mJ", ({ values }) => digits(1e3 * values.received_J)],
];

export class Robot {
  constructor() {
    this.panel = byId("robot");
    this.known = { facts: null, values: {}, leader: undefined, state: undefined, hand_N: NaN };
    this.texts = kRows.map(([title, unit]) => {
      const text = make("dd", {});
      const head = make("dt", {}, title);
      if (unit) head.append(" ", make("span", { className: "unit" }, `[${unit}]`));
      byId("robot-numbers").append(make("div", {}, head, text));
      return text;
    });
  }

  /** Whether there is one. */
  get present() {
    return this.known.facts !== null;
  }

  /** @param {object|undefined} facts of a `scene` message */
  setFacts(facts) {
    this.known.facts = facts ?? this.known.facts;
    this.#show();
  }

  /** @param {object} more of what is known: values, leader, state, hand_N */
  set(more) {
    Object.assign(this.known, more);
    const told = kStates[this.known.values.state];
    if (more.values && told) this.known.state = told;
    this.#show();
  }

  /** Another program, or another scene of it. */
  clear() {
    this.known = { facts: null, values: {}, leader: undefined, state: undefined, hand_N: NaN };
    this.#show();
  }

  #show() {
    const { known } = this;
    const shown = known.facts !== null || known.state !== undefined;
    this.panel.hidden = !shown;
    document.body.dataset.robot = String(shown);
    if (!shown) return;
    const all = { ...known, facts: known.facts ?? {} };
    kRows.forEach(([, , text], i) => setText(this.texts[i], text(all)));
    this.panel.dataset.state = known.state ?? "";
    setText(byId("robot-name"), known.facts?.name ?? "");
    byId("robot-title").title = known.facts?.task ?? "";
    setText(byId("robot-hint"), kHints[known.state] ?? "");
  }
}
