// The robot at the far end in numbers: what both ends do, how they are tied, and the robot's energy.
import { byId, make, setText } from "./dom.js";
import { digits } from "./text.js";

/** Of control/follower_state.hpp, by their numbers. */
export const kStates = ["none", "waiting", "following", "clutched", "holding", "stopping", "stopped", "failed",
  "taken"];

/** What the operator does so that it follows, by `leader_has_clutch`; nobody leads: -1; a server that does not tell: undefined. */
const kWays = new Map([[1, "press and release the clutch"], [0, "keep the device still for a moment"], [undefined, "engage"]]);
const kWaysAnew = new Map([...kWays, [0, "move the device, and keep it still for a moment"]]);

const kHints = {
  waiting: (clutch) => (clutch === -1 ? "nobody leads it" : `${kWays.get(clutch)}, and it follows`),
  following: () => "its tool moves with the hand",
  clutched: () => "it holds its place while the hand moves elsewhere, until the clutch is released",
  holding: () => "the hand was not heard for 100 ms: it holds its place",
  stopping: () => "it is brought to rest",
  stopped: (clutch) => (clutch === -1 ? "it is at rest, and nobody leads it" : `it is at rest: ${kWaysAnew.get(clutch)}, and it follows again`),
  failed: () => "it refuses: the server's log says why",
  taken: () => "another device leads it, which took it while this one was silent",
};

const size = (values, what, unit) => Math.hypot(...["x", "y", "z"].map((name) => values[`${what}_${name}_${unit}`] ?? NaN));
const pair = (...numbers) => (numbers.every(Number.isNaN) ? "–" : numbers.map((number) => digits(number)).join(", "));

/** Title, unit and text of each number. Lag: of the tool behind its target; drift: by how much the hand moved in pauses. */
const kRows = [
  ["Leader", "", ({ leader }) => leader ?? "–"],
  ["Robot", "", ({ state }) => state ?? "–"],
  ["Gripper", "", ({ values, state }) =>
    (state !== "following" ? "–" : values.grip_waits ? "waits for your grip" : "goes with your grip")],
  ["Clutch", "", ({ state, values }) => (values.leader_has_clutch === 0 ? "none" : state === "clutched" ? "pressed" : "released")],
  ["Architecture", "", ({ facts }) => facts.architecture ?? "–"],
  ["Its law", "", ({ facts }) => facts.law ?? "–"],
  ["Motion, force ×", "", ({ facts }) => pair(facts.motion_scale ?? NaN, facts.force_scale ?? NaN)],
  ["Force on the hand", "N", ({ hand_N }) => digits(hand_N)],
  ["On its surroundings", "N", ({ values }) => digits(size(values, "force", "N"))],
  ["Torque on them", "N m", ({ values }) => digits(size(values, "torque", "N_m"))],
  ["Sensor's bias", "", ({ values }) => (values.bias_age_s >= 0 ? `learned ${digits(values.bias_age_s)} s ago` : "–")],
  ["Lag, drift", "mm", ({ values }) => pair(1e3 * values.lag_m, 1e3 * values.drift_m)],
  ["P + store, least", "mJ", ({ values }) => pair(1e3 * values.passivity_J, 1e3 * values.least_passivity_J)],
  ["Energy store", "mJ", ({ values, facts }) => `${digits(1e3 * values.store_J)} of ${digits(1e3 * facts.store_J)}`],
  ["From the hand", "mJ", ({ values }) => digits(1e3 * values.received_J)],
];

export class Robot {
  constructor() {
    this.panel = byId("robot");
    this.known = { facts: null, values: {}, leader: undefined, state: undefined, hand_N: NaN };
    this.rows = kRows.map(([title, unit]) => {
      const text = make("dd", {});
      const head = make("dt", {}, title);
      if (unit) head.append(" ", make("span", { className: "unit" }, `[${unit}]`));
      const row = make("div", {}, head, text);
      byId("robot-numbers").append(row);
      return { row, text };
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
    kRows.forEach(([, , textOf], i) => {
      const { row, text } = this.rows[i];
      setText(text, textOf(all));
      row.hidden = text.textContent === "–"; // nobody here knows it
    });
    this.panel.dataset.state = known.state ?? "";
    setText(byId("robot-name"), known.facts?.name ?? "");
    byId("robot-title").title = known.facts?.task ?? "";
    setText(byId("robot-hint"), kHints[known.state]?.(known.values.leader_has_clutch) ?? "");
  }
}
