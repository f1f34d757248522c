// The network as two pipes: motions on their way to the server, forces on their way back.
import { byId, fitCanvas, setText } from "./dom.js";
import { digits, whole } from "./text.js";
import { colours, lessMotion } from "./theme.js";

const kDotsMost = 60;
const kLost_ms = 900;

/** A pipe with as many dots as packets are on their way. */
class Pipe {
  constructor(id, forwards) {
    this.canvas = byId(id);
    this.forwards = forwards;
    this.flying = 0;
    this.lost = 0;
    this.losses = []; // {at, where}: shown for a moment
    this.phase = 0;
  }

  update(flying, lost, now) {
    const more = lost - this.lost;
    if (more > 0 && this.known) {
      for (let i = 0; i < Math.min(more, 2); ++i) this.losses.push({ at: now, where: 0.2 + 0.6 * Math.random() });
    }
    this.known = true;
    this.lost = lost;
    this.flying = flying;
  }

  /** @param {number} step share of the pipe that a packet has gone since the last drawing */
  draw(now, step) {
    const ratio = fitCanvas(this.canvas);
    const context = this.canvas.getContext("2d");
    const { width, height } = this.canvas;
    const middle = height / 2;
    const radius = height * 0.36;
    context.clearRect(0, 0, width, height);
    context.lineWidth = ratio;
    context.strokeStyle = colours.faint;
    context.fillStyle = colours["view-back"];
    context.beginPath();
    context.roundRect(ratio, middle - radius, width - 2 * ratio, 2 * radius, radius);
    context.fill();
    context.stroke();
    this.phase = (this.phase + step) % 1;
    const dots = Math.min(Math.round(this.flying), kDotsMost);
    context.fillStyle = colours["track-0"];
    for (let i = 0; i < dots; ++i) {
      const share = ((i + 0.5) / dots + this.phase / dots) % 1;
      this.#dot(context, this.forwards ? share : 1 - share, width, middle, Math.min(0.5 * radius, (0.34 * width) / dots));
    }
    this.losses = this.losses.filter((loss) => now - loss.at < kLost_ms);
    for (const loss of this.losses) this.#cross(context, loss.where * width, middle, 0.62 * radius, 1 - (now - loss.at) / kLost_ms);
  }

  #dot(context, share, width, y, radius) {
    context.beginPath();
    context.arc(2 * radius + share * (width - 4 * radius), y, radius, 0, 2 * Math.PI);
    context.fill();
  }

  #cross(context, x, y, size, strength) {
    context.save();
    context.globalAlpha = strength;
    context.strokeStyle = colours.bad;
    context.lineWidth = size / 2;
    context.beginPath();
    context.moveTo(x - size, y - size);
    context.lineTo(x + size, y + size);
    context.moveTo(x + size, y - size);
    context.lineTo(x - size, y + size);
    context.stroke();
    context.restore();
  }
}

export class Pipes {
  constructor(changed) {
    this.changed = changed;
    this.up = new Pipe("pipe-up", true);
    this.down = new Pipe("pipe-down", false);
    this.delay_ms = 20;
    this.last = performance.now();
  }

  /** @param {object|null} network of a `status` message @param {object|null} relay of the settings */
  show(network, relay) {
    byId("pipes").hidden = !network;
    byId("no-network").hidden = Boolean(network);
    if (!network) return;
    const trip = network.round_trip_ms;
    this.delay_ms = Math.max((trip?.median ?? 2 * (relay?.delay_ms ?? 10)) / 2, 1);
    const now = performance.now();
    this.up.update(network.in_flight_up ?? 0, network.lost_up ?? 0, now);
    this.down.update(network.in_flight_down ?? 0, network.lost_down ?? 0, now);
    const percent = (lost, of) => (of > 0 ? `${digits((100 * lost) / of, 2)} %` : "–");
    const flying = (count) => (count === null || count === undefined ? "" : `${whole(count)} on the way, `);
    setText(byId("up-text"), `${flying(network.in_flight_up)}${percent(network.lost_up, network.sent)} lost`);
    setText(byId("down-text"),
      `${flying(network.in_flight_down)}${percent(network.lost_down, network.received + network.lost_down)} lost`);
    setText(byId("trip-text"), trip ? `Round trip ${digits(trip.median)} ms, 1 % above ${digits(trip.p99)} ms` : "Round trip not known yet");
    this.changed();
  }

  /** @returns {boolean} whether something still moves */
  draw() {
    const now = performance.now();
    const dots = Math.max(Math.min(this.up.flying, kDotsMost), 1);
    // The phase is a share of the space between two dots. What is fast is shown slower, to be seen.
    const step = lessMotion() ? 0 : (Math.min(now - this.last, 100) / Math.max(this.delay_ms, 400)) * dots;
    this.last = now;
    this.up.draw(now, step);
    this.down.draw(now, step);
    return !lessMotion() && (this.up.flying > 0 || this.up.losses.length > 0);
  }
}
