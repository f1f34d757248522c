// Looks at a running program as Foxglove does, with the official client of its protocol.
//
//   node live.mjs ADDRESS [--server] [--ticks COUNT] [--calls]
//
// ADDRESS is the page's, as the program prints it. Two viewers subscribe to every channel and decode every message by the
// schema that was advertised: of a client every tick must come, but for those that its page counts as left out, and each
// picture must be of a tick at its time. What is refused must be refused in one line while the others are served on.
// --calls: services are called too, and /live tells what came of it. --server: of a server, which has no ticks.
import assert from "node:assert/strict";
import { request } from "node:http";
import { createInterface } from "node:readline";
import { parseArgs } from "node:util";

import { decoderOf, load } from "./recording.mjs";

const { foxglove, ws } = load({ foxglove: "@foxglove/ws-protocol", ws: "ws" });
const { FoxgloveClient } = foxglove;
const { WebSocket } = ws;

const { positionals, values: options } = parseArgs({
  allowPositionals: true,
  options: { server: { type: "boolean" }, ticks: { type: "string", default: "2000" }, calls: { type: "boolean" } },
});
const address = new URL(positionals[0]);
const token = address.searchParams.get("token");
const kOfClient = {
  "/tick": "forcebound.v1.TickRecord",
  "/force": "forcebound.v1.ForceRecord",
  "/scene": "foxglove.SceneUpdate",
  "/device": "foxglove.FrameTransform",
  "/arrows": "foxglove.SceneUpdate",
};
const kOfServer = { ...kOfClient, "/motion": "forcebound.v1.MotionSample" };
delete kOfServer["/tick"];
const expected = options.server ? kOfServer : kOfClient;

const target = (path, with_token = token) => `${path}?token=${with_token}`;
const ended = (emitter, event) => new Promise((done) => emitter.once(event, done));

/// Rejects if it does not come in a minute.
async function within(promise, what) {
  let timer;
  const late = new Promise((_, fail) => (timer = setTimeout(() => fail(new Error(`${what} does not come`)), 60_000)));
  return await Promise.race([promise, late]).finally(() => clearTimeout(timer));
}

class Viewer {
  constructor() {
    // As from Foxglove's own page, which is of another origin.
    const socket = new WebSocket(`ws://${address.host}${target("/")}`, [FoxgloveClient.SUPPORTED_SUBPROTOCOL], {
      origin: "https://app.foxglove.dev",
    });
    this.socket = socket;
    this.client = new FoxgloveClient({ ws: socket });
    this.messages = new Map(Object.keys(expected).map((topic) => [topic, []]));
    this.bytes = 0;
    this.statuses = [];
    this.answers = new Map();
    this.waiting = [];
    this.client.on("status", (message) => this.#add(() => this.statuses.push(message)));
    this.client.on("error", (error) => assert.fail(error));
    this.client.on("serviceCallResponse", (answer) => this.#add(() => this.answers.set(answer.callId, answer)));
    this.client.on("serviceCallFailure", (answer) => this.#add(() => this.answers.set(answer.callId, answer)));
    this.client.on("serverInfo", (info) => (this.info = info));
    this.client.on("advertiseServices", (services) => this.#add(() => (this.services = services)));
    this.client.on("advertise", (channels) => this.#add(() => (this.channels = channels)));
    this.client.on("message", ({ subscriptionId, timestamp, data }) => {
      const { topic, decode } = this.subscriptions.get(subscriptionId);
      const bytes = new Uint8Array(data.buffer, data.byteOffset, data.byteLength);
      this.bytes += bytes.length;
      this.#add(() => this.messages.get(topic).push({ at: timestamp, ...decode(bytes) }));
    });
  }

  #add(store) {
    store();
    this.waiting = this.waiting.filter(({ condition, done }) => !condition() || done());
  }

  until(condition, what) {
    if (condition()) return Promise.resolve();
    return within(new Promise((done) => this.waiting.push({ condition, done })), what);
  }

  subscribe() {
    this.subscriptions = new Map();
    for (const { id, topic, schemaName, schema } of this.channels) {
      const decode = decoderOf({ name: schemaName, encoding: "protobuf", data: Buffer.from(schema, "base64") });
      this.subscriptions.set(this.client.subscribe(id), { topic, decode });
    }
  }

  of(topic) {
    return this.messages.get(topic);
  }

  /// The status that a message is answered with.
  async refusal(message) {
    const before = this.statuses.length;
    this.socket.send(message);
    await this.until(() => this.statuses.length > before, "a status");
    const { level, message: text } = this.statuses.at(-1);
    assert.equal(level, 2);
    assert.ok(!text.includes("\n"), text);
    return text;
  }

  #calls = 0;
  async call(name, value, encoding = "json") {
    const service = this.services?.find((one) => one.name === name);
    const callId = ++this.#calls;
    const data = new TextEncoder().encode(typeof value === "string" ? value : JSON.stringify({ value }));
    this.client.sendServiceCallRequest({ serviceId: service?.id ?? 99, callId, encoding, data });
    await this.until(() => this.answers.has(callId), `an answer of ${name}`);
    return this.answers.get(callId);
  }
}

function get(path) {
  return new Promise((done, fail) => {
    const asked = request(`http://${address.host}${path}`, (answer) => {
      let text = "";
      answer.on("data", (part) => (text += part));
      answer.on("end", () => done({ status: answer.statusCode, text }));
    });
    asked.on("error", fail);
    asked.end();
  });
}

/// Lines of JSON until one is what is waited for.
function line(condition) {
  return new Promise((done, fail) => {
    const asked = request(`http://${address.host}${target("/live")}`, (answer) => {
      assert.equal(answer.statusCode, 200);
      assert.equal(answer.headers["transfer-encoding"], "chunked");
      const lines = createInterface(answer);
      lines.on("error", () => {});  // that we hang up
      lines.on("line", (text) => {
        const row = JSON.parse(text);
        if (!condition(row)) return;
        asked.destroy();
        done(row);
      });
    });
    asked.on("error", fail);
    asked.end();
  });
}

/// The status by which a WebSocket is refused, 101 if it is not. A request that the page has not read after 5 s is ended
/// without one: a busy machine asks again.
async function refused(path, subprotocols, origin) {
  for (let attempt = 0; attempt < 5; ++attempt) {
    const socket = new WebSocket(`ws://${address.host}${path}`, subprotocols, { origin });
    const status = new Promise((done) => {
      socket.once("unexpected-response", (_, answer) => done(answer.resume().statusCode));
      socket.once("open", () => done(101));
      socket.once("error", () => done(undefined));
    });
    const found = await within(status, path);
    if (found) return found;
  }
  assert.fail(`${path} is ended without an answer`);
}

async function expectRefusals(viewer) {
  const { SUPPORTED_SUBPROTOCOL: ours } = FoxgloveClient;
  const elsewhere = "https://app.foxglove.dev";
  assert.equal(await refused(target("/", "0".repeat(32)), [ours]), 401);
  assert.equal(await refused(target("/", "0".repeat(32)), [ours], elsewhere), 403);
  assert.equal(await refused(target("/"), ["foxglove.websocket.v0"]), 400);
  assert.equal(await refused(target("/"), [], elsewhere), 403);
  const channels = viewer.channels.length;
  const subscribe = (id, channelId) => JSON.stringify({ op: "subscribe", subscriptions: [{ id, channelId }] });
  assert.equal(await viewer.refusal(subscribe(50, 99)), `there is no channel 99; accepted are 1 to ${channels}`);
  assert.equal(await viewer.refusal(subscribe(50, 1)), "channel 1 has a subscription already");
  assert.equal(await viewer.refusal('{"op":"unsubscribe","subscriptionIds":[50]}'), "there is no subscription 50");
  assert.match(await viewer.refusal(subscribe(-1, 1)), /^id is -1; accepted is a whole number/);
  assert.match(await viewer.refusal('{"op":"subscribe"}'), /^subscriptions is null; accepted is a list/);
  assert.match(await viewer.refusal('{"op":"advertise"}'), /^op is "advertise"; accepted are "subscribe"/);
  assert.equal(await viewer.refusal("\u0000 garbage"), "a message must be a JSON object");
  assert.match(await viewer.refusal(Buffer.from([0xff, 1, 2, 3])), /^of binary messages calls of services/);
  assert.match(await viewer.refusal(Buffer.alloc(0)), /^of binary messages calls of services/);
  assert.equal(await viewer.refusal(Buffer.from([2, 1, 0, 0])), "a binary message ends too early");
}

async function expectCalls(viewer) {
  const names = viewer.services.map(({ name }) => name);
  assert.deepEqual(names, ["law", "law_beside", "scene", "device", "stiffness_N_per_m", "network"].map((one) => `/choose/${one}`));
  const failure = async (...call) => {
    const { op, message } = await viewer.call(...call);
    assert.equal(op, "serviceCallFailure");
    assert.ok(!message.includes("\n"), message);
    return message;
  };
  const success = async (...call) => {
    const { op, encoding, data, message } = await viewer.call(...call);
    assert.equal(op, 3, message);
    assert.equal(encoding, "json");
    assert.equal(new TextDecoder().decode(data), "{}");
  };
  assert.match(await failure("/choose/law", "fba-exakt", "ros1"), /^encoding is 'ros1'; accepted is json/);
  assert.match(await failure("/choose/law", "not JSON"), /^a call needs a JSON object/);
  assert.match(await failure("/choose/law", 7), /^law must be a name/);
  assert.match(await failure("/choose/law", ["fba"]), /^value is \["fba"\]; accepted is/);
  assert.match(await failure("/nothing", 7), /^there is no service 99; accepted are 1 to 6/);
  const network = { delay_ms: 12, jitter_ms: 0, loss_percent: 0 };
  assert.match(await failure("/choose/network", { ...network, delay_ms: -1 }), /^delay_ms is -1/);
  await success("/choose/network", network);
  await within(line(({ kind, settings }) => kind === "hello" && settings.network.delay_ms === 12), "the network");
  const before = viewer.of("/tick").length;
  const last = BigInt(viewer.of("/tick").at(-1).tick);
  await success("/choose/law", JSON.stringify({ value: "fba-more" }));
  await within(line(({ kind, settings }) => kind === "hello" && settings.law === "fba-more"), "the law");
  // Its first ticks may be left out.
  await viewer.until(() => viewer.of("/tick").slice(before).some(({ tick }) => BigInt(tick) < last), "the next run");
}

async function countOf(name) {
  const { text } = await get(target("/metrics"));
  return Number(text.match(new RegExp(`^${name} (\\d+)$`, "m"))?.[1]);
}

const nanoseconds = ({ seconds, nanos }) => BigInt(seconds) * 1_000_000_000n + BigInt(nanos);

/// @returns ticks that are missing
function checkTicks(viewer) {
  const ticks = viewer.of("/tick");
  const times = new Map(ticks.map((tick) => [tick.at, tick]));
  const [first, last] = [ticks.at(0), ticks.at(-1)];
  let pictures = 0;
  for (const { at, timestamp, child_frame_id, parent_frame_id, translation } of viewer.of("/device")) {
    assert.equal(nanoseconds(timestamp), at);
    assert.equal(parent_frame_id, "scene");
    assert.equal(child_frame_id, "device");
    const tick = times.get(at);
    if (!tick) continue;
    assert.deepEqual([translation.x, translation.y, translation.z].slice(0, tick.position_m.length), tick.position_m);
    ++pictures;
  }
  assert.ok(pictures > 0, "no picture is of a tick");
  assert.ok(viewer.of("/arrows").some(({ entities }) => entities.some(({ spheres }) => spheres.length > 0)));
  return Number(last.tick) - Number(first.tick) + 1 - ticks.length;
}

const wanted = Number(options.ticks);
const main = options.server ? "/motion" : "/tick";
const viewers = [new Viewer(), new Viewer()];
for (const viewer of viewers) {
  await viewer.until(() => viewer.channels && (options.server || viewer.services), "what there is");
  assert.equal(viewer.socket.protocol, FoxgloveClient.SUPPORTED_SUBPROTOCOL);
  assert.match(viewer.info.name, options.server ? /^forcebound-server / : /^forcebound-client /);
  assert.deepEqual(viewer.info.capabilities, options.server ? [] : ["services"]);
  const found = Object.fromEntries(viewer.channels.map(({ topic, schemaName }) => [topic, schemaName]));
  assert.deepEqual(found, expected);
  viewer.subscribe();
}
const began = performance.now();
for (const viewer of viewers) {
  await viewer.until(() => viewer.of(main).length >= wanted, `${wanted} on ${main}`);
  await viewer.until(() => viewer.of("/force").length > 0 && viewer.of("/scene").length > 0, "forces and the scene");
}
const took_s = (performance.now() - began) / 1000;
const [viewer, other] = viewers;
const rate = Math.round(viewer.bytes / took_s / 1000);
const parts = viewer.of("/scene").at(-1).entities.length;
assert.ok(parts > 0, "the scene is empty");
let missing = 0;
if (!options.server) {
  for (const one of viewers) missing += checkTicks(one);
  const left_out = (await countOf("forcebound_client_records_dropped_total")) + (await countOf("forcebound_page_skipped_total"));
  assert.ok(missing <= 2 * left_out, `${missing} ticks are missing, ${left_out} messages were left out`);
} else {
  assert.ok(viewer.of("/device").some(({ child_frame_id }) => child_frame_id.startsWith("server's device ")));
}
await expectRefusals(viewer);
const so_far = other.of(main).length;
await other.until(() => other.of(main).length >= so_far + 100, "what others are sent meanwhile");
if (options.calls) await expectCalls(viewer);
if (options.server) assert.equal((await viewer.call("/choose/law", 7)).message, "there are no services here");
const lines = await within(line(({ kind }) => kind === (options.server ? "sessions" : "ticks")), "a line");
assert.ok((lines.time_s ?? lines.sessions).length > 0);
for (const one of viewers) {
  one.client.close();
  await ended(one.socket, "close");
}
console.log(`two viewers decode all: ${viewer.of(main).length} on ${main}, ${missing} left out, ${rate} kB/s each, a scene of ${parts}`);
process.exit(0);
