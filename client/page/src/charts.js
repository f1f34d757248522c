// Strip charts over the newest ticks, with one cursor for all; pause, zoom, and back to now.
import uPlot from "uplot";
import { byId, make, onResize, setText } from "./dom.js";
import { digits } from "./text.js";
import { colours, onTheme } from "./theme.js";
import { TickStore } from "./tickstore.js";

const kHeld_s = 65;
const kWindows_s = [0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 60];
const kPoints = 800; // about two for each pixel across
const kGap = 4; // rows without a value that a line goes over: ticks are not exactly a period apart
const kTracks = 2;
const kValues = ["x", "y", "z", "asked", "applied", "age", "ledger", "passivity"];
const kAxes = ["x", "y", "z"];

/** What is drawn: the title with its unit, the least height of the axis, and its lines. */
const kCharts = [
  { id: "position", title: "Position", unit: "mm", least: 2, lines: [
    { value: "x", label: "x", colour: "axis-x" }, { value: "y", label: "y", colour: "axis-y" },
    { value: "z", label: "z", colour: "axis-z" }] },
  { id: "force", title: "Force", unit: "N", least: 0.5, zero: true, lines: [
    { value: "asked", label: "asked", colour: "asked" }, { value: "applied", label: "applied", colour: "applied" }] },
  { id: "age", title: "Age of the force", unit: "ms", least: 2, zero: true, lines: [
    { value: "age", label: "age", colour: "own" }] },
  { id: "ledger", title: "Energy in the ledger", unit: "mJ", least: 1, zero: true, lines: [
    { value: "ledger", label: "energy", colour: "own" }] },
  { id: "passivity", title: "P, true energy balance", unit: "mJ", least: 1, zero: true, forbidden: true, lines: [
    { value: "passivity", label: "P", colour: "own" }] },
];

/** A number on an axis: 1500 is 1.5k. */
function short(value) {
  const text = Math.abs(value) >= 1000 ? `${+(value / 1000).toPrecision(4)}k` : `${+value.toPrecision(6)}`;
  return text.replace("-", "−");
}

/**
 * Draws a line through what is there, with a gap where nothing is. In place of uPlot's own paths: joints without rounding
 * take a part of the time where there is no graphics card.
 */
function strokeLine(u, series) {
  const { ctx } = u;
  const xs = u.data[0];
  const ys = u.data[series];
  const { show, scale, width, dash, stroke } = u.series[series];
  if (!show || xs.length === 0) return;
  // Straight lines: two numbers each, found once for all points.
  const x0 = u.valToPos(0, "x", true);
  const perX = u.valToPos(1, "x", true) - x0;
  const y0 = u.valToPos(0, scale, true);
  const perY = u.valToPos(1, scale, true) - y0;
  ctx.save();
  ctx.beginPath();
  ctx.rect(u.bbox.left, u.bbox.top, u.bbox.width, u.bbox.height);
  ctx.clip();
  ctx.beginPath();
  let last = -Infinity;
  for (let i = 0; i < xs.length; ++i) {
    const y = ys[i];
    if (y !== y) continue;
    if (i - last <= kGap) ctx.lineTo(x0 + perX * xs[i], y0 + perY * y);
    else ctx.moveTo(x0 + perX * xs[i], y0 + perY * y);
    last = i;
  }
  ctx.lineJoin = "bevel";
  ctx.lineWidth = width * uPlot.pxRatio;
  ctx.strokeStyle = stroke();
  ctx.setLineDash((dash ?? []).map((length) => length * uPlot.pxRatio));
  ctx.stroke();
  ctx.restore();
}

/** The range of an axis; it rests as long as what is drawn fits it well. */
class RestingRange {
  constructor(least, zero) {
    Object.assign(this, { least, zero, low: 0, high: least });
  }

  /** Takes in what is drawn now. */
  fit(from, to) {
    if (from > to) return; // nothing is drawn
    const below = this.zero ? Math.min(from, 0) : from;
    const above = this.zero ? Math.max(to, 0) : to;
    const span = Math.max(above - below, this.least);
    if (below >= this.low && above <= this.high && span > 0.45 * (this.high - this.low)) return;
    const step = 10 ** Math.floor(Math.log10(span)) / 2;
    const spare = (span - (above - below)) / 2;
    const round = (value, way) => (this.zero && value === 0 ? 0 : way(value / step) * step);
    this.low = this.zero && below === 0 ? 0 : round(below - spare - 0.05 * span, Math.floor);
    this.high = this.zero && above === 0 ? 0 : round(above + spare + 0.05 * span, Math.ceil);
  }
}

/** Least and largest of the shown lines. */
function extremes(data, series) {
  let [low, high] = [Infinity, -Infinity];
  for (let i = 1; i < data.length; ++i) {
    if (!series[i].show) continue;
    for (const value of data[i]) {
      if (value < low) low = value;
      if (value > high) high = value;
    }
  }
  return [low, high];
}

/** One chart: its heading with the values under the cursor, and the drawing. */
class Chart {
  constructor(facts, owner) {
    this.facts = facts;
    this.owner = owner;
    this.legend = make("ul", { className: "lines" });
    this.drawing = make("div", { className: "drawing" });
    this.root = make("section", { className: "chart", "aria-label": `${facts.title} in ${facts.unit}` },
      make("h3", {}, `${facts.title} `, make("span", { className: "unit" }, `[${facts.unit}]`)), this.legend, this.drawing);
    this.hidden = new Set();
    this.range = new RestingRange(facts.least, facts.zero);
    this.plot = null;
    onResize(this.drawing, () => {
      if (this.plot) this.plot.setSize(this.#size());
      owner.changed();
    });
  }

  #size() {
    return { width: Math.max(this.drawing.clientWidth, 50), height: Math.max(this.drawing.clientHeight, 40) };
  }

  /** Lines for these tracks and axes. */
  build(tracks, dof) {
    this.plot?.destroy();
    this.lines = [];
    for (let track = 0; track < tracks; ++track) {
      for (const line of this.facts.lines) {
        if (kAxes.indexOf(line.value) >= dof) continue;
        const colour = line.colour === "own" ? `track-${track}` : line.colour;
        this.lines.push({ ...line, track, colour, column: this.owner.store.column(`${track}.${line.value}`) });
      }
    }
    this.columns = this.lines.map((line) => line.column);
    this.data = [[], ...this.lines.map(() => [])];
    const last = this.facts === kCharts.at(-1);
    const small = () => `${0.72 * parseFloat(getComputedStyle(document.documentElement).fontSize)}px system-ui, sans-serif`;
    const axis = { stroke: () => colours.faint, font: small(), grid: { stroke: () => colours.line, width: 1 }, ticks: { show: false } };
    this.plot = new uPlot({
      ...this.#size(),
      legend: { show: false },
      cursor: {
        sync: { key: "ticks" }, drag: { x: true, y: false, setScale: false, dist: 6 }, points: { size: 6 },
        bind: { dblclick: () => () => { this.owner.live(); return null; } },
      },
      select: { show: true },
      scales: { x: { time: false }, y: { auto: false, range: () => [this.range.low, this.range.high] } },
      padding: [7, 8, last ? 0 : 6, 0],
      axes: [
        { ...axis, size: last ? 18 : 0, gap: 2, values: (u, ticks) => ticks.map((tick) => (last ? `${+tick.toFixed(3)} s` : null)) },
        { ...axis, size: 42, gap: 3, space: 18, values: (u, ticks) => ticks.map(short) },
      ],
      series: [{}, ...this.lines.map((line) => ({
        stroke: () => colours[line.colour], width: line.value === "asked" ? 2.2 : 1.5, points: { show: false },
        dash: line.track ? [7, 4] : undefined, show: !this.hidden.has(line.value), paths: () => null,
      }))],
      hooks: {
        drawSeries: [strokeLine],
        drawClear: this.facts.forbidden ? [(u) => this.#markForbidden(u)] : [],
        setSelect: [(u) => this.owner.select(u)],
        setCursor: [() => this.owner.cursorMoved(this)],
      },
    }, this.data, this.drawing);
    this.#buildLegend();
  }

  /** One button for each value, with one number for each track. */
  #buildLegend() {
    this.values = [];
    for (const { value, label } of this.facts.lines) {
      const own = this.lines.filter((line) => line.value === value);
      if (own.length === 0) continue;
      const button = make("button", { type: "button", className: "line", title: `Show or hide ${label}` }, label);
      button.setAttribute("aria-pressed", String(!this.hidden.has(value)));
      for (const line of own) {
        const output = make("output", { className: "value" }, "–");
        output.dataset.value = `${line.track}.${value}`;
        button.append(make("i", { className: `swatch colour-${line.colour}${line.track ? " dashed" : ""}` }), output);
        this.values.push({ line, output });
      }
      button.addEventListener("click", () => this.toggle(value, button));
      this.legend.append(make("li", {}, button));
    }
  }

  toggle(value, button) {
    const shown = this.hidden.delete(value);
    if (!shown) this.hidden.add(value);
    button.setAttribute("aria-pressed", String(shown));
    this.lines.forEach((line, index) => {
      if (line.value === value) this.plot.setSeries(index + 1, { show: shown });
    });
    this.owner.changed();
  }

  /** Below zero the device gave energy to the hand. */
  #markForbidden(u) {
    const zero = u.valToPos(0, "y", true);
    const { left, top, width, height } = u.bbox;
    const low = Math.min(Math.max(zero, top), top + height);
    u.ctx.save();
    u.ctx.fillStyle = colours.bad;
    u.ctx.globalAlpha = 0.13;
    u.ctx.fillRect(left, low, width, top + height - low);
    u.ctx.globalAlpha = 0.8;
    if (low === zero) u.ctx.fillRect(left, zero, width, 1);
    u.ctx.restore();
  }

  draw(from_s, to_s) {
    this.owner.store.window(this.columns, from_s, to_s, kPoints, this.data);
    this.range.fit(...extremes(this.data, this.plot.series));
    this.plot.batch(() => {
      this.plot.setData(this.data, false);
      this.plot.setScale("x", { min: from_s, max: to_s });
      this.plot.setScale("y", { min: this.range.low, max: this.range.high });
    });
  }

  showValues(time_s) {
    for (const { line, output } of this.values) setText(output, digits(this.owner.store.at(line.column, time_s)));
  }
}

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
    this.#takeKeys();
    this.#takeWheel();
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

  #takeKeys() {
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

  #takeWheel() {
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
