// What a live page costs the tick of the client that serves it, and what viewers who mean harm get: node load.mjs --bin
// FOLDER --page FOLDER [--rounds N] [--seconds S]
//
//     server <-- client [--page <-- two viewers, or those who mean harm]
//
// Runs alternate: without a page, with a page and two viewers who read, with two who speak Foxglove's protocol and
// subscribe to all, then with each harm. A run's figures are its own
// summary's; beside each tick's period stands that of a thread that only sleeps, in the same process and run.
import { readdirSync, readFileSync, statSync } from "node:fs";
import { loadavg } from "node:os";
import { connect } from "node:net";
import { request } from "node:http";
import { join } from "node:path";
import { parseArgs } from "node:util";
import { gzipSync } from "node:zlib";
import { packages } from "./browser.mjs";
import { withPrograms } from "./programs.mjs";

const { values: given } = parseArgs({ options: { bin: { type: "string" }, page: { type: "string" },
  rounds: { type: "string", default: "5" }, seconds: { type: "string", default: "10" } } });
const { WebSocket } = packages()("ws");
const kBeforeEnd_ms = 1000;

const live = (url, token = true) => {
  const at = new URL(url);
  at.protocol = "ws:";
  at.pathname = "/live";
  if (!token) at.search = "";
  return at;
};

const pause = (ms) => new Promise((done) => setTimeout(done, ms));

/** A viewer who reads. @returns {{got: number, bytes: number, close: () => void}} what has come so far */
async function viewer(url, subprotocol = []) {
  const socket = new WebSocket(live(url), subprotocol);
  const seen = { got: 0, bytes: 0, close: () => socket.terminate() };
  socket.on("message", (data) => {
    ++seen.got;
    seen.bytes += data.length;
  });
  socket.on("error", () => {});
  await new Promise((done) => socket.on("open", done));
  return Object.assign(seen, { socket });
}

/** A viewer who speaks Foxglove's protocol and subscribes to all that there is. */
async function foxglove(url) {
  const seen = await viewer(url, ["foxglove.websocket.v1"]);
  seen.socket.on("message", (data, is_binary) => {
    if (is_binary) return;
    const { op, channels } = JSON.parse(data);
    if (op !== "advertise") return;
    const subscriptions = channels.map(({ id }) => ({ id, channelId: id }));
    seen.socket.send(JSON.stringify({ op: "subscribe", subscriptions }));
  });
  return seen;
}

/** The status of one request. */
function status(url, options = {}) {
  return new Promise((done) => {
    const asked = request(url, options, (reply) => {
      reply.resume();
      done(reply.statusCode);
    });
    asked.on("upgrade", (reply, socket) => {
      socket.destroy();
      done(101);
    });
    asked.on("error", (error) => done(error.code));
    asked.end();
  });
}

const upgrade = (url, headers = {}) => {
  const at = live(url, headers.token !== false);
  at.protocol = "http:";
  delete headers.token;
  return status(at, { headers: { Connection: "Upgrade", Upgrade: "websocket", "Sec-WebSocket-Version": "13",
    "Sec-WebSocket-Key": "AAAAAAAAAAAAAAAAAAAAAA==", ...headers } });
};

/** Until the run ends, all say this as fast as they may. */
async function flood(url, text) {
  const socket = new WebSocket(live(url));
  socket.on("error", () => {});
  await new Promise((done) => socket.on("open", done));
  let sent = 0;
  const timer = setInterval(() => {
    for (let i = 0; i < 2000 && socket.bufferedAmount < 1e6; ++i, ++sent) socket.send(text);
  }, 5);
  return { close: () => (clearInterval(timer), socket.terminate()), said: () => `${sent} messages were sent` };
}

/** What each does to a page. @returns {Promise<{close: () => void, said: () => string}>} */
const harms = {
  "never reads": async (url) => {
    const at = new URL(url);
    const sockets = Array.from({ length: 2 }, () => {
      const socket = connect(Number(at.port), at.hostname);
      socket.on("error", () => {});
      socket.write(`GET /live${at.search} HTTP/1.1\r\nHost: ${at.host}\r\nConnection: Upgrade\r\nUpgrade: websocket\r\n` +
        "Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\n\r\n");
      return socket.pause();
    });
    return { close: () => sockets.forEach((socket) => socket.destroy()), said: () => "two viewers who take nothing" };
  },
  "floods": (url) => flood(url, JSON.stringify({ kind: "hand", point_m: [0, 0, 0.05] })),
  "sends garbage": (url) => flood(url, "\u0001{]".repeat(300)),
  "1000 sockets": async (url) => {
    const at = new URL(url);
    const ends = {};
    const sockets = Array.from({ length: 1000 }, () => {
      const socket = connect(Number(at.port), at.hostname);
      const note = (end) => (ends[end] = (ends[end] ?? 0) + 1);
      socket.once("data", (data) => note(/HTTP\/1.1 (\d+)/.exec(data)?.[1]));
      socket.on("error", (error) => note(error.code));
      return socket;
    });
    return { close: () => sockets.forEach((socket) => socket.destroy()),
      said: () => `answered: ${Object.entries(ends).map(([end, count]) => `${count} x ${end}`).join(", ") || "none"}` };
  },
  "wrong origin, host, token": async (url) => {
    const seen = {};
    let going = true;
    const ask = async () => {
      while (going) {
        for (const [name, asked] of [["origin", () => upgrade(url, { Origin: "http://elsewhere.example" })],
          ["host", () => upgrade(url, { Host: "elsewhere.example" })], ["no token", () => upgrade(url, { token: false })],
          ["metrics without token", () => status(new URL("/metrics", url))]]) {
          const answer = await asked();
          seen[`${name} ${answer}`] = (seen[`${name} ${answer}`] ?? 0) + 1;
          await pause(2);
        }
      }
    };
    ask();
    return { close: () => (going = false), said: () => Object.entries(seen).map(([what, count]) => `${what} (${count})`).join(", ") };
  },
};

/** One run. @param with_page {(url: string) => Promise<{close, said}>|null} */
async function run(programs, address, name, with_page) {
  const options = ["--server", address, "--scene", "sphere", "--device", "omni", "--operator", "trace-sphere", "--quiet",
    "--scene-cache", "none", "--duration", given.seconds, "--summary", `${name}.json`];
  const load = loadavg()[0];
  const client = with_page ? await programs.withPage("client", options) : programs.start("client", options);
  const doing = with_page ? await with_page(client.url) : null;
  if (doing) await pause(Number(given.seconds) * 1000 - kBeforeEnd_ms);
  const said = doing?.said?.() ?? "";
  doing?.close();
  await client.ended;
  const summary = JSON.parse(readFileSync(join(programs.folder, `${name}.json`), "utf8"));
  return { load, said, period: summary.period_us, idle: summary.idle_timer?.period_us, work: summary.tick_latency_us,
    late: summary.late_ticks, allocations: summary.faults.tick_allocations };
}

const median = (values) => [...values].sort((a, b) => a - b)[Math.floor(values.length / 2)];
const show = (value) => (Number.isFinite(value) ? value.toPrecision(4) : "-").padStart(8);
const kColumns = ["p50", "p99.9", "p99.9", "p50", "p99"];

function row(name, runs) {
  const of = (pick) => show(median(runs.map(pick)));
  console.log(`${name.padEnd(27)}${of(({ period }) => period.p50)}${of(({ period }) => period.p999)}${of(({ idle }) => idle?.p999)}` +
    `${of(({ work }) => work.p50)}${of(({ work }) => work.p99)}${String(runs.reduce((sum, { allocations }) => sum + allocations, 0)).padStart(6)}` +
    `${runs.map(({ load }) => load).reduce((a, b) => Math.max(a, b)).toFixed(1).padStart(6)}`);
}

function weigh(folder) {
  let plain = 0;
  let packed = 0;
  for (const name of readdirSync(folder)) {
    const path = join(folder, name);
    if (!statSync(path).isFile()) continue;
    const content = readFileSync(path);
    plain += content.length;
    packed += gzipSync(content).length;
  }
  console.log(`page: ${(plain / 1000).toFixed(0)} kB as it is sent, ${(packed / 1000).toFixed(0)} kB packed by gzip`);
}

await withPrograms(given.bin, async (programs) => {
  const server = await programs.server();
  const rounds = Number(given.rounds);
  const two = (kind) => async (url) => {
    const both = [await kind(url), await kind(url)];
    return { close: () => both.forEach((each) => each.close()),
      said: () => `each got ${(both[0].bytes / 1000 / Number(given.seconds)).toFixed(0)} kB/s` };
  };
  const without = [];
  const watched = [];
  const elsewhere = [];
  for (let round = 0; round < rounds; ++round) {
    without.push(await run(programs, server.address, `without-${round}`, null));
    watched.push(await run(programs, server.address, `watched-${round}`, two(viewer)));
    elsewhere.push(await run(programs, server.address, `elsewhere-${round}`, two(foxglove)));
  }
  console.log(`medians of ${rounds} runs of ${given.seconds} s each, of viewers who mean harm one run; times in us`);
  console.log(`${" ".repeat(27)}${"period".padStart(16)}${"idle".padStart(8)}${"work".padStart(16)}`);
  console.log(`${" ".repeat(27)}${kColumns.map((name) => name.padStart(8)).join("")}${"alloc".padStart(6)}${"load".padStart(6)}`);
  row("without a page", without);
  row("two viewers", watched);
  row("two of Foxglove's protocol", elsewhere);
  const said = [`two viewers: ${watched[0].said}`, `two of Foxglove's protocol: ${elsewhere[0].said}`];
  for (const [name, harm] of Object.entries(harms)) {
    const runs = [await run(programs, server.address, name.replace(/\W+/g, "-"), harm)];
    row(name, runs);
    said.push(`${name}: ${runs[0].said}`);
  }
  console.log("period of the tick; idle: the same of a thread that only sleeps");
  console.log("work: from reading to command; alloc: in the tick, in all");
  for (const line of said) console.log(line);
  weigh(given.page);
});
