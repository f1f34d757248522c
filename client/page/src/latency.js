// Where the time goes: one row for each stage of the forces that reached the device, a histogram over a common
// logarithmic axis and the median. The program tells medians; nothing is read from the bins.
import { byId, canvasFont, fitCanvas, onResize } from "./dom.js";
import { digits } from "./text.js";
import { colours } from "./theme.js";

const kStages = [
  { key: "network", label: "Network", colour: "track-0" },
  { key: "server", label: "Server", colour: "asked" },
  { key: "waiting", label: "Waiting", colour: "track-1" },
  { key: "total", label: "Total", colour: "good" },
];

export class Latency {
  constructor() {
    this.canvas = byId("histogram");
    this.text = byId("histogram-text");
    this.stages = null;
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
      `${label}: median ${digits(this.stages[key].median)} ms, 99 % below ${digits(this.stages[key].p99)} ms.`).join(" ");
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
    const { font, size_px: size } = canvasFont(0.74, ratio);
    context.font = font;
    context.textBaseline = "middle";
    context.clearRect(0, 0, width, height);
    const medians = this.known.map(({ key }) => `${digits(this.stages[key].median)} ms`);
    const widest = (texts) => Math.max(...texts.map((text) => context.measureText(text).width));
    const left = widest(this.known.map(({ label }) => label)) + size;
    const right = width - widest(medians) - size;
    const bottom = height - 1.5 * size;
    const { low, high } = this.#range();
    const x = (value) => left + ((Math.log10(Math.max(value, low)) - Math.log10(low)) / Math.log10(high / low)) * (right - left);
    this.#axis(context, { low, high, x, bottom, size, height });
    const row = bottom / this.known.length;
    this.known.forEach(({ key, label, colour }, index) => {
      const { edges, counts } = this.stages[key];
      const base = (index + 1) * row - 2 * ratio;
      const tall = row - 5 * ratio;
      const most = Math.max(...counts);
      context.fillStyle = colours[colour];
      counts.forEach((count, i) => {
        if (count === 0) return;
        const bar = Math.max((count / most) * tall, ratio);
        const from = x(edges[i]);
        context.fillRect(from, base - bar, Math.max(x(edges[i + 1]) - from - 0.5 * ratio, ratio), bar);
      });
      context.fillStyle = colours.line;
      context.fillRect(left, base, right - left, ratio);
      context.fillStyle = colours.text;
      context.textAlign = "left";
      context.fillText(label, 0, base - tall / 2);
      context.textAlign = "right";
      context.fillText(medians[index], width, base - tall / 2);
    });
  }

  /** Decades, each with its number where that has room. */
  #axis(context, { low, high, x, bottom, size, height }) {
    context.textAlign = "center";
    let free = -Infinity; // right of the last number
    for (let decade = low; decade <= high * 1.001; decade *= 10) {
      context.fillStyle = colours.line;
      context.fillRect(x(decade), 0, 1, bottom);
      const text = `${+decade.toPrecision(1)}`;
      const half = context.measureText(text).width / 2;
      if (x(decade) - half < free) continue;
      free = x(decade) + half + size / 2;
      context.fillStyle = colours.faint;
      context.fillText(text, x(decade), height - 0.6 * size);
    }
  }
}
