// Strip charts over the newest ticks, with one cursor for all; pause, zoom, and back to now.
import { Chart, kAxes } from "./chart.js";
import { byId, setText } from "./dom.js";
import { digits } from "./text.js";
import { onTheme } from "./theme.js";
import { TickStore } from "./tickstore.js";

const kHeld_s = 65;
const kWindows_s = [0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 60];
const kTracks = 2;
const kValues = ["x", "y", "z", "asked", "applied", "age", "ledger", "passivity"];

/** What is drawn: the title with its unit, the least height of the axis, and its lines. */
const kCharts = [
  { id: "position", title: "Position", unit: "mm", least: 2, lines: [
    { value: "x", label: "x", colour: "axis-x" }, { value: "y", label: "y", colour: "axis-y" },
    { value: "z", label: "z", colour: "axis-z" }] },
  { id: "force", title: "Force", unit: "N", least: 0.5, zero: true, lines: [
    { value: "asked", label: "asked", colour: "asked" }, { value: "applied", label: "applied", colour: "applied" }] },
  { id: "age", title: "Age of the force", unit: "ms", least: 2, zero: true, lines: [
    { value: "age", label: "age", colour: "own" }] },
  { id: "ledger", title: "Energy in the ledger", help: "ledger", unit: "mJ", least: 1, zero: true, lines: [
    { value: "ledger", label: "energy", colour: "own" }] },
  { id: "passivity", title: "P, true energy balance", help: "passivity", unit: "mJ", least: 1, zero: true, forbidden: true, last: true, lines: [
    { value: "passivity", label: "P", colour: "own" }] },
];

export class Charts {
  /** @param {() => void} changed asks for a frame */
  constructor(changed) {
    this.changed = changed;
    this.tracks = 1;
    this.dof = 3;
    this.window_s = 10;
    this.end_s = null; // null: now
    this.cursor_s = null;
    this.moving = false;
    this.store = null;
    this.charts = kCharts.map((facts) => new Chart(facts, this));
    this.area = byId("strips");
    this.area.append(...this.charts.map((chart) => chart.root));
    this.pauseButton = byId("pause");
    this.pauseButton.addEventListener("click", () => (this.end_s === null ? this.pause() : this.live()));
    byId("longer").addEventListener("click", () => this.#zoomTo(1));
    byId("shorter").addEventListener("click", () => this.#zoomTo(-1));
    this.#listenToKeys();
    this.#listenToWheel();
    onTheme(() => this.#rebuild());
    this.#showState();
  }

  /** A new period, number of axes or tracks; history stays where it can. */
  setUp({ period_s, dof, tracks }) {
    const same = this.store && this.store.period_s === period_s;
    if (!same) {
      const names = [];
      for (let track = 0; track < kTracks; ++track) names.push(...kValues.map((value) => `${track}.${value}`));
      this.store = new TickStore(names, period_s, kHeld_s);
    }
    if (same && this.dof === dof && this.tracks === tracks) return;
    if (this.tracks !== tracks && dof > 1) this.#showAxes(tracks > 1 ? [kAxes[dof - 1]] : kAxes);
    this.dof = dof;
    this.tracks = tracks;
    this.#rebuild();
  }

  /** With two tracks six lines would be too many. */
  #showAxes(axes) {
    const position = this.charts[0];
    position.hidden = new Set(kAxes.filter((axis) => !axes.includes(axis)));
  }

  #rebuild() {
    if (!this.store) return;
    for (const chart of this.charts) {
      chart.legend.replaceChildren();
      chart.build(this.tracks, this.dof);
    }
    this.changed();
  }

  clear() {
    this.store?.clear();
    this.live();
  }

  /** Takes the ticks of a message. */
  add(track, message) {
    const { store } = this;
    if (!store || track >= kTracks) return;
    const before_s = store.newest_s;
    const base = store.column(`${track}.x`);
    const size = (force) => (force === null || force === undefined ? NaN
      : force.length === 1 ? force[0] : Math.hypot(...force));
    message.time_s.forEach((time_s, i) => {
      const row = store.row(time_s);
      const place = message.position_m?.[i];
      if (place) for (let axis = 0; axis < place.length; ++axis) store.set(row, base + axis, 1000 * place[axis]);
      store.set(row, base + 3, size(message.asked_N?.[i]));
      store.set(row, base + 4, size(message.applied_N?.[i]));
      store.set(row, base + 5, message.age_ms?.[i] ?? NaN);
      store.set(row, base + 6, message.ledger_mJ?.[i] ?? NaN);
      store.set(row, base + 7, message.passivity_mJ?.[i] ?? NaN);
    });
    // Time that went back is another run: what is stopped in the old one has nothing to show.
    if (this.end_s !== null && store.newest_s < before_s - 1) this.live();
    this.changed();
  }

  pause() {
    if (!this.store) return;
    this.end_s = this.store.newest_s;
    this.#showState();
  }

  live() {
    this.end_s = null;
    if (this.window_s < 1) this.window_s = 1;
    this.#showState();
  }

  /** A part chosen with the pointer fills the charts, which stop. */
  select(u) {
    if (u.select.width < 6) return;
    const from = u.posToVal(u.select.left, "x");
    const to = u.posToVal(u.select.left + u.select.width, "x");
    this.window_s = Math.max(to - from, 5 * this.store.period_s);
    this.end_s = to;
    for (const chart of this.charts) chart.plot.setSelect({ left: 0, width: 0, top: 0, height: 0 }, false);
    this.#showState();
  }

  #zoomTo(direction) {
    const longer = kWindows_s.filter((span) => span > this.window_s * 1.01);
    const shorter = kWindows_s.filter((span) => span < this.window_s * 0.99);
    const next = direction > 0 ? longer[0] : shorter.at(-1);
    if (next === undefined) return;
    if (this.end_s !== null) this.end_s = Math.min(this.end_s - this.window_s / 2 + next / 2, this.store.newest_s);
    this.window_s = next;
    this.#showState();
  }

  cursorMoved(chart) {
    if (this.moving) return;
    const { left } = chart.plot.cursor;
    this.cursor_s = left >= 0 ? chart.plot.posToVal(left, "x") : null;
    this.#showValues();
  }

  /** Puts the cursor of all charts at a time, by the keyboard. */
  #moveCursor(by_s) {
    if (this.end_s === null) this.pause();
    const from = this.end_s - this.window_s;
    this.cursor_s = Math.min(Math.max((this.cursor_s ?? this.end_s) + by_s, from), this.end_s);
    const { plot } = this.charts[0];
    plot.setCursor({ left: plot.valToPos(this.cursor_s, "x"), top: 5 });
  }

  #listenToKeys() {
    const keys = {
      ArrowLeft: () => this.#moveCursor(-this.window_s / 100),
      ArrowRight: () => this.#moveCursor(this.window_s / 100),
      " ": () => (this.end_s === null ? this.pause() : this.live()),
      "+": () => this.#zoomTo(-1),
      "-": () => this.#zoomTo(1),
      Home: () => this.live(),
    };
    this.area.addEventListener("keydown", (event) => {
      if (event.target !== this.area || !keys[event.key] || event.ctrlKey || event.altKey || event.metaKey) return;
      keys[event.key]();
      event.preventDefault();
    });
  }

  #listenToWheel() {
    this.area.addEventListener("wheel", (event) => {
      const scrolls = document.documentElement.scrollHeight > window.innerHeight + 1;
      if (scrolls && !event.ctrlKey) return;
      event.preventDefault();
      if (Math.abs(event.deltaY) > 5) this.#zoomTo(Math.sign(event.deltaY));
    }, { passive: false });
  }

  #showState() {
    const live = this.end_s === null;
    setText(this.pauseButton, live ? "Pause" : "Go on");
    this.pauseButton.setAttribute("aria-pressed", String(!live));
    setText(byId("window"), `${digits(this.window_s)} s`);
    this.area.classList.toggle("stopped", !live);
    this.changed();
  }

  #showValues() {
    if (!this.store || this.store.empty) return;
    const time_s = this.cursor_s ?? this.end_s ?? this.store.newest_s;
    for (const chart of this.charts) chart.showValues(time_s);
  }

  draw() {
    if (!this.store || !this.charts[0].plot) return;
    const to_s = this.end_s ?? Math.max(this.store.newest_s, this.store.oldest_s + this.window_s);
    this.moving = true;
    for (const chart of this.charts) chart.draw(to_s - this.window_s, to_s);
    this.moving = false;
    const { left } = this.charts[0].plot.cursor;
    if (left >= 0) this.cursor_s = this.charts[0].plot.posToVal(left, "x");
    this.#showValues();
  }
}
