// One strip chart: its heading with the values under the cursor, and the drawing.
import uPlot from "uplot";
import { canvasFont, make, onResize, setText } from "./dom.js";
import { helpButton } from "./help.js";
import { digits } from "./text.js";
import { colours } from "./theme.js";

export const kAxes = ["x", "y", "z"];

const kPoints = 800; // about two for each pixel across
const kGap = 4; // rows without a value that a line goes over: ticks are not exactly a period apart

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

/**
 * What it draws: `facts` as charts.js lists them. Its owner has the ticks, and is told of the cursor and of what is chosen.
 */
export class Chart {
  constructor(facts, owner) {
    this.facts = facts;
    this.owner = owner;
    this.legend = make("ul", { className: "lines" });
    this.drawing = make("div", { className: "drawing" });
    const title = make("h3", {}, `${facts.title} `, make("span", { className: "unit" }, `[${facts.unit}]`));
    if (facts.help) title.append(" ", helpButton(facts.help));
    this.root = make("section", { className: "chart", "aria-label": `${facts.title} in ${facts.unit}` }, title, this.legend, this.drawing);
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
    const last = this.facts.last ?? false;
    const axis = { stroke: () => colours.faint, font: canvasFont(0.72).font, grid: { stroke: () => colours.line, width: 1 }, ticks: { show: false } };
    this.plot = new uPlot({
      ...this.#size(),
      legend: { show: false },
      cursor: {
        sync: { key: "ticks" }, drag: { x: true, y: false, setScale: false, dist: 6 }, points: { size: 6 },
        bind: { dblclick: () => () => { this.owner.live(); return null; } },
      },
      select: { show: true },
      scales: { x: { time: false }, y: { auto: false, range: () => [this.range.low, this.range.high] } },
      padding: [7, 14, last ? 0 : 6, 0],
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
