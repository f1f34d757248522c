// A small program that speaks as our own do to the live page: node stand_in.mjs PAGE [--port N] [--program client|server|view] [--axes N]
//
// A hand on a device that feels a dome through a network with delay: enough to draw, and to be lost and found again.
import { createServer } from "node:http";
import { readFile } from "node:fs/promises";
import { createRequire } from "node:module";
import { extname, join, resolve } from "node:path";
import { parseArgs } from "node:util";

const kPeriod_s = 0.001;
const kDamping_N_s_per_m = 2;
const kMass_kg = 0.08;
const kHand = { stiffness_N_per_m: 500, damping_N_s_per_m: 4 };
const kMime = { ".html": "text/html", ".js": "text/javascript", ".css": "text/css", ".svg": "image/svg+xml", ".txt": "text/plain" };
export const kPolicy = "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self'; connect-src 'self'";

const kScenes = {
  dome: { shapes: [{ name: "dome", kind: "sphere", center_m: [0, 0, 0], radius_m: 0.04 }, { name: "table", kind: "half_space", through_m: [0, 0, -0.01], normal: [0, 0, 1] }] },
  wall: { shapes: [{ name: "wall", kind: "half_space", through_m: [0], normal: [-1] }] },
  zoo: { shapes: [
    { name: "box", kind: "box", center_m: [-0.06, 0, 0.01], size_m: [0.03, 0.04, 0.02], moves: true },
    { name: "rod", kind: "capsule", from_m: [-0.03, 0.05, 0.02], to_m: [0.05, 0.05, 0.02], radius_m: 0.012 },
    { name: "post", kind: "cylinder", from_m: [0.06, 0, 0], to_m: [0.06, 0, 0.05], radius_m: 0.012 },
    { name: "ring", kind: "torus", center_m: [0, -0.05, 0.01], axis: [0, 0.3, 1], major_radius_m: 0.025, minor_radius_m: 0.008 },
    { name: "relief", kind: "height_field", origin_m: [-0.02, -0.02, 0.012], spacing_m: 0.004,
      heights_m: Array.from({ length: 11 }, (_, j) => Array.from({ length: 11 }, (_, i) => 0.004 * Math.sin(i / 2) * Math.cos(j / 2))) },
    { name: "table", kind: "half_space", through_m: [0, 0, 0], normal: [0, 0, 1] }] },
};

const add = (a, b, scale = 1) => a.map((value, i) => value + scale * b[i]);
const dot = (a, b) => a.reduce((sum, value, i) => sum + value * b[i], 0);

/** The force of the scene on a point: a ball of 40 mm, or a wall at x = 0 on one axis. */
function sceneForce(place, stiffness) {
  if (place.length === 1) return { force: [Math.min(0, -stiffness * place[0])], normal: [-1], contact: place[0] > 0 };
  const away = Math.hypot(...place);
  const deep = 0.04 - away;
  const normal = place.map((value) => value / (away || 1));
  return { force: normal.map((value) => Math.max(0, deep) * stiffness * value), normal, contact: deep > 0 };
}

/** One session: device, hand and law, and what is on its way. */
class Track {
  constructor(law, dof, start) {
    Object.assign(this, { law, dof, position: [...start], velocity: start.map(() => 0), ledger: 0, passivity: 0, least: 0 });
    this.way = []; // {arrives, force, place}
    this.newest = { force: start.map(() => 0), place: null, sent: 0, normal: null, contact: false };
    this.touched = false;
    this.lost = 0;
    this.sent = 0;
    this.ticks = [];
  }

  tick(time_s, hand, network, stiffness) {
    const delay = () => (network.delay_ms + network.jitter_ms * (2 * Math.random() - 1)) / 1000;
    ++this.sent;
    if (Math.random() < 2 * network.loss_percent / 100) ++this.lost;
    else {
      const made = sceneForce(this.position, stiffness);
      this.way.push({ arrives: time_s + delay() + delay(), sent: time_s, place: [...this.position], ...made });
    }
    for (const packet of this.way) if (packet.arrives <= time_s && packet.sent > this.newest.sent) this.newest = packet;
    this.way = this.way.filter((packet) => packet.arrives > time_s);
    const asked = this.newest.force.map((value) => Math.max(-30, Math.min(30, value)));
    const moved = this.velocity.map((value) => value * kPeriod_s);
    this.ledger += kDamping_N_s_per_m * dot(moved, moved) / kPeriod_s - dot(this.applied ?? asked, moved);
    let applied = asked;
    if (this.law !== "none") {
      this.ledger = Math.max(this.ledger, 0);
      const size = Math.hypot(...asked);
      const most = Math.sqrt(4 * kDamping_N_s_per_m * this.ledger / kPeriod_s);
      if (size > most) applied = asked.map((value) => (value * most) / size);
    }
    const push = hand ? add(hand, this.position, -1).map((value, i) => kHand.stiffness_N_per_m * value - kHand.damping_N_s_per_m * this.velocity[i]) : this.velocity.map((v) => -v);
    this.passivity += kDamping_N_s_per_m * dot(moved, moved) / kPeriod_s - dot(applied, moved);
    this.least = Math.min(this.least, this.passivity);
    const force = add(add(applied, push), this.velocity, -kDamping_N_s_per_m);
    this.velocity = add(this.velocity, force, kPeriod_s / kMass_kg);
    this.position = add(this.position, this.velocity, kPeriod_s);
    this.applied = applied;
    this.touched ||= this.newest.contact;
    this.ticks.push({ time_s, position_m: this.position, place_m: this.newest.place, asked_N: asked, applied_N: applied,
      age_ms: this.newest.sent ? 1000 * (time_s - this.newest.sent) : null, ledger_mJ: this.law === "none" ? null : 1000 * this.ledger,
      passivity_mJ: 1000 * this.passivity, contact: this.newest.contact ? 1 : 0 });
  }
}

const kKeys = ["time_s", "position_m", "place_m", "asked_N", "applied_N", "age_ms", "ledger_mJ", "passivity_mJ", "contact"];

export class StandIn {
  /** @param {object} more of a robot or a handle that turns: what each `moved` and `ticks` message also has */
  constructor({ packages, program = "client", axes = 3, audited = true, still = false, recording = null, robot = null, moved = null, turned = null, tool_m = null }) {
    const scene = axes === 1 ? "wall" : "dome";
    Object.assign(this, { program, axes, audited, still, robot, moved, turned, tool_m, time_s: 0, hand: null, heard: [], clients: new Set(), kicked: new Set() });
    this.Sockets = packages("ws").WebSocketServer;
    this.settings = { law: "fba-exact", law_beside: null, scene, device: "cartesian-3dof", stiffness_N_per_m: 3000,
      network: { delay_ms: 20, jitter_ms: 2, loss_percent: 1 } };
    this.recording = recording;
    this.begin();
  }

  begin() {
    const start = this.axes === 1 ? [-0.03] : [0.012, 0, 0.07].slice(0, this.axes);
    this.tracks = [this.settings.law, this.settings.law_beside].filter(Boolean).map((law) => new Track(law, this.axes, start));
    this.rest = start;
  }

  hello() {
    const laws = [{ name: "fba-exact", about: "Bounds the force by the energy that the device's damping has taken, for real encoders and clocks." },
      { name: "fba-more", about: "The paper's more conservative law." }, { name: "none", about: "Applies the force as it comes." }];
    const tracks = this.program === "server" ? [] : this.tracks.map(({ law }) => ({ law }));
    return { kind: "hello", protocol: 1, program: this.program, version: "0.2.0", time_s: this.time_s, period_s: kPeriod_s, dof: this.axes,
      simulated: true, pointer: this.program === "client", may_change: true, choices: { laws, scenes: ["dome", "wall", "zoo"], devices: ["cartesian-3dof", "omni"] },
      settings: this.settings, recording: this.recording, duration_s: this.program === "view" ? 60 : null, tracks, read_only: false };
  }

  scene(track) {
    return { kind: "scene", track, name: this.settings.scene, meshes: [], more: "", ...kScenes[this.settings.scene],
      ...(this.robot ? { robot: this.robot } : {}), ...(this.tool_m ? { tool_m: this.tool_m } : {}) };
  }

  async listen(folder, port = 0) {
    this.server = createServer(async (request, reply) => {
      const path = new URL(request.url, "http://x").pathname;
      try {
        const body = await readFile(join(folder, path === "/" ? "index.html" : path));
        reply.writeHead(200, { "Content-Type": kMime[extname(path)] ?? "text/html", "Content-Security-Policy": kPolicy, "X-Content-Type-Options": "nosniff" });
        reply.end(body);
      } catch {
        reply.writeHead(404).end("no such file");
      }
    });
    this.sockets = new this.Sockets({ server: this.server, path: "/live" });
    this.sockets.on("connection", (socket) => this.#meet(socket));
    await new Promise((done) => this.server.listen(port, "127.0.0.1", done));
    this.port = this.server.address().port;
    this.started = Date.now() - 1000 * this.time_s;
    this.timers = [setInterval(() => this.#advance(), 16), setInterval(() => this.#tell(), 250)];
    return `http://127.0.0.1:${this.port}/?token=t`;
  }

  async close() {
    this.timers.forEach(clearInterval);
    const closed = new Promise((done) => this.server.close(done));
    // Those too that are on their way in: the server waits for all.
    this.sockets.on("connection", (socket) => socket.terminate());
    for (const socket of this.clients) socket.terminate();
    this.server.closeAllConnections();
    await closed;
  }

  send(message) {
    const text = JSON.stringify(message);
    for (const socket of this.clients) socket.send(text);
  }

  #greet() {
    this.send(this.hello());
    if (this.program === "server" && this.robot) this.send(this.scene(0));
    if (this.program !== "server") this.tracks.forEach((_, track) => this.send(this.scene(track)));
  }

  #meet(socket) {
    this.clients.add(socket);
    socket.on("close", () => this.clients.delete(socket));
    socket.on("message", (data) => this.#take(JSON.parse(data)));
    this.#greet();
  }

  #take(message) {
    this.heard.push(message);
    if (message.kind === "hand") this.hand = message.point_m;
    if (message.kind === "hand_free") this.hand = null;
    if (message.kind === "kick") this.kicked.add(message.session);
    if (message.kind === "record") this.recording = message.on ? "run.mcap" : null;
    if (message.kind === "choose") {
      if (message.setting === "device") return this.send({ kind: "refused", about: "device", text: `device '${message.value}' is not plugged in` });
      this.settings = { ...this.settings, [message.setting]: message.value };
      if (message.setting !== "network") this.begin();
      this.send({ kind: "event", track: 0, time_s: this.time_s, level: "info", text: `${message.setting} is now ${JSON.stringify(message.value)}` });
    }
    if (["choose", "record"].includes(message.kind)) this.#greet();
  }

  #advance() {
    const until = (Date.now() - this.started) / 1000;
    if (until - this.time_s > 0.5) this.time_s = until - 0.5; // a busy machine: skip
    while (this.time_s < until) {
      this.time_s += kPeriod_s;
      const wave = this.axes === 1 ? [0.01 * Math.sin(2 * this.time_s)] : [0.012 + 0.02 * Math.sin(this.time_s), 0.01 * Math.cos(this.time_s), 0.034];
      for (const track of this.tracks) track.tick(this.time_s, this.hand ?? (this.still ? this.rest : wave.slice(0, this.axes)), this.settings.network, this.settings.stiffness_N_per_m);
    }
    if (this.moved) this.send({ kind: "moved", track: 0, meshes: [], bodies: [], ...this.moved });
    this.tracks.forEach((track, index) => {
      if (this.program === "server" || track.ticks.length === 0) return;
      const ticks = Object.fromEntries(kKeys.map((key) => [key, track.ticks.map((tick) => tick[key])]));
      if (!this.audited) ticks.passivity_mJ = ticks.passivity_mJ.map(() => null);
      const { normal, place, contact } = track.newest;
      const surface = normal && this.axes === 3 ? normal.map((value) => 0.04 * value) : place;
      this.send({ kind: "ticks", track: index, ...ticks, plane: contact ? { point_m: surface, normal } : null, hand_m: this.hand, ...this.turned });
      track.ticks = [];
    });
  }

  #tell() {
    if (this.program === "server") return this.#tellSessions();
    const { delay_ms, jitter_ms, loss_percent } = this.settings.network;
    const edges = Array.from({ length: 41 }, (_, i) => 0.01 * 10 ** (i / 8));
    const spread = (middle, width) => ({ median: middle, p99: 2 * middle, edges, counts: edges.slice(1).map((edge) => Math.round(4000 * Math.exp(-((Math.log(edge / middle) / width) ** 2)))) });
    this.tracks.forEach((track, index) => this.send({ kind: "status", track: index, state: "connected",
      touched: track.touched, passive: this.audited ? track.least > -0.01 : null, least_passivity_mJ: this.audited ? 1000 * track.least : null,
      network: { sent: track.sent, received: track.sent - track.lost, lost_up: Math.round(track.lost / 2), lost_down: Math.round(track.lost / 2),
        in_flight_up: Math.round(delay_ms), in_flight_down: Math.round(delay_ms * (1 - loss_percent / 100)), round_trip_ms: { median: 2 * delay_ms + 0.3, p99: 2 * (delay_ms + jitter_ms) } },
      stages_ms: { network: spread(2 * delay_ms + 0.2, 0.2 + jitter_ms / 50), server: spread(0.03, 0.5), waiting: spread(0.6, 0.7), total: spread(2 * delay_ms + 0.9, 0.25 + jitter_ms / 50) },
      tick: { period_us: { median: 1000, p99: 1012 }, late: 0, dropped_for_page: 0 } }));
  }

  #tellSessions() {
    const sessions = ["anna", "bert", "carla"].map((client, i) => ({ id: i + 1, client, address: `127.0.0.1:5${i}012`, scene: "dome", device: "omni", state: "connected",
      lost_up_percent: 0.5 * i, compute_us: { median: 12.3, p99: 40 },
      faults: i === 1 ? [{ name: "malformed", count: 3 }] : [], since_s: this.time_s })).filter(({ id }) => !this.kicked.has(id));
    this.send({ kind: "sessions", sessions, load: { processor_percent: 12.5, motions_per_s: 1000 * sessions.length, places_used: sessions.length, places: 16 } });
  }
}

if (import.meta.url === `file://${process.argv[1]}`) {
  const { values, positionals } = parseArgs({ allowPositionals: true, options: { port: { type: "string", default: "51400" },
    program: { type: "string", default: "client" }, axes: { type: "string", default: "3" }} });
  const stand = new StandIn({ program: values.program, axes: Number(values.axes), packages: createRequire(resolve("node_modules/x")) });
  console.log(await stand.listen(positionals[0], Number(values.port)));
}
