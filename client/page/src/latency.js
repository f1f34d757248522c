// Where the time goes: one row for each stage of a round trip, a histogram over a common logarithmic axis.
import { byId, fitCanvas, onResize } from "./dom.js";
import { digits } from "./text.js";
import { colours } from "./theme.js";

const kStages = [
  { key: "network", label: "Network", colour: "track-0" },
  { key: "server", label: "Server", colour: "asked" },
  { key: "waiting", label: "Waiting", colour: "track-1" },
  { key: "total", label: "Total", colour: "good" },
];

/** @returns {number|null} the value below which a share of what was counted lies */
export function quantile({ edges, counts }, share) {
  const total = counts.reduce((sum, count) => sum + count, 0);
  if (total === 0) return null;
  let left = share * total;
  for (let i = 0; i < counts.length; ++i) {
    if (left <= counts[i] && counts[i] > 0) return edges[i] + (edges[i + 1] - edges[i]) * (left / counts[i]);
    left -= counts[i];
  }
  return edges.at(-1);
}

export class Latency {
  constructor() {
    this.canvas = byId("histogram");
    this.text = byId("histogram-text");
    this.stages = null;
    this.dirty = true;
    onResize(this.canvas, () => this.draw());
  }

  show(stages) {
    this.stages = stages ?? {};
    const known = kStages.filter(({ key }) => this.stages[key]?.counts.some((count) => count > 0));
    byId("no-latency").hidden = known.length > 0;
    this.canvas.hidden = known.length === 0;
    this.known = known;
    // For those who cannot see the drawing.
    this.text.textContent = known.map(({ key, label }) =>
      `${label}: median ${digits(quantile(this.stages[key], 0.5))} ms, 99 % below ${digits(quantile(this.stages[key], 0.99))} ms.`).join(" ");
    this.draw();
  }

  #range() {
    let [low, high] = [Infinity, 0];
    for (const { key } of this.known) {
      const { edges, counts } = this.stages[key];
      counts.forEach((count, i) => {
        if (count === 0) return;
        low = Math.min(low, edges[i] > 0 ? edges[i] : edges[i + 1] / 2);
        high = Math.max(high, edges[i + 1]);
      });
    }
    low = 10 ** Math.floor(Math.log10(Math.max(low, 1e-4)));
    return { low, high: 10 ** Math.ceil(Math.log10(Math.max(high, 2 * low))) };
  }

  draw() {
    if (!this.known?.length || this.canvas.clientWidth === 0) return;
    const ratio = fitCanvas(this.canvas);
    const context = this.canvas.getContext("2d");
    const { width, height } = this.canvas;
    const font = 0.74 * parseFloat(getComputedStyle(document.documentElement).fontSize) * ratio;
    context.font = `${font}px system-ui, sans-serif`;
    context.textBaseline = "middle";
    context.clearRect(0, 0, width, height);
    const left = 4.6 * font;
    const right = width - 5.2 * font;
    const bottom = height - 1.5 * font;
    const { low, high } = this.#range();
    const x = (value) => left + ((Math.log10(Math.max(value, low)) - Math.log10(low)) / Math.log10(high / low)) * (right - left);
    this.#axis(context, { low, high, x, bottom, font, height });
    const row = bottom / this.known.length;
    this.known.forEach(({ key, label, colour }, index) => {
      const { edges, counts } = this.stages[key];
      const base = (index + 1) * row - 2 * ratio;
      const tall = row - 5 * ratio;
      const most = Math.max(...counts);
      context.fillStyle = colours[colour];
      counts.forEach((count, i) => {
        if (count === 0) return;
        const size = Math.max((count / most) * tall, ratio);
        const from = x(edges[i]);
        context.fillRect(from, base - size, Math.max(x(edges[i + 1]) - from - 0.5 * ratio, ratio), size);
      });
      context.fillStyle = colours.line;
      context.fillRect(left, base, right - left, ratio);
      context.fillStyle = colours.text;
      context.textAlign = "left";
      context.fillText(label, 0, base - tall / 2);
      context.textAlign = "right";
      context.fillText(`${digits(quantile(this.stages[key], 0.5))} ms`, width, base - tall / 2);
    });
  }

  #axis(context, { low, high, x, bottom, font, height }) {
    context.textAlign = "center";
    for (let decade = low; decade <= high * 1.001; decade *= 10) {
      context.fillStyle = colours.line;
      context.fillRect(x(decade), 0, 1, bottom);
      context.fillStyle = colours.faint;
      context.fillText(`${+decade.toPrecision(1)}`, x(decade), height - 0.6 * font);
    }
  }
}
