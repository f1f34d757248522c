// Reads a recording as Foxglove does, with the official reader, and finds in it what its 3D panel shows.
//
//   node foxglove.mjs RECORDING.mcap [--server]
//
// Every message of one of Foxglove's schemas is decoded by the schema in the file and by the official one, and must say
// the same; what the file declares must be the official fields. The frames must be connected, and each arrow must be
// the force of the tick at its time, 10 mm for each newton. Prints a message of each topic. --server: of a server's
// recording, which has no ticks.
import assert from "node:assert/strict";
import { existsSync } from "node:fs";
import { parseArgs } from "node:util";

import { decoderOf, openIndexed, protobuf, schemas, typeOf } from "./recording.mjs";

const { positionals, values: options } = parseArgs({
  allowPositionals: true,
  options: { server: { type: "boolean" } },
});
const [file] = positionals;
assert.ok(file && existsSync(file), `no such recording: '${file}'`);

const kMetresPerNewton = 0.01;
const kFrame = "scene";

/// All official schemas as Protocol Buffers.
function officialRoot() {
  const root = new protobuf.Root();
  const parse = (text) => protobuf.parse(text, root, { keepCase: true });
  for (const name of ["Timestamp", "Duration"]) {
    parse(`syntax = "proto3"; package google.protobuf; message ${name} { int64 seconds = 1; int32 nanos = 2; }`);
  }
  const { foxgloveMessageSchemas, foxgloveEnumSchemas, generateProto } = schemas;
  for (const schema of Object.values(foxgloveMessageSchemas)) {
    const nested = Object.values(foxgloveEnumSchemas).filter((one) => one.parentSchemaName === schema.name);
    parse(generateProto(schema, nested));
  }
  return root.resolveAll();
}

const official = officialRoot();

/// What a message declares: names, numbers and types of its fields, and those within.
function declared(type, seen = new Map()) {
  const name = type.fullName.replace(/^\./, "");
  if (seen.has(name)) return seen;
  if (type instanceof protobuf.Enum) {
    seen.set(name, { ...type.values });
    return seen;
  }
  const fields = type.fieldsArray.map((field) => {
    const of = field.resolvedType ? field.resolvedType.fullName.replace(/^\./, "") : field.type;
    return `${field.id} ${field.repeated ? "repeated " : ""}${of} ${field.name}`;
  });
  seen.set(name, fields.sort());
  if (name.startsWith("foxglove.")) {
    for (const field of type.fieldsArray) if (field.resolvedType) declared(field.resolvedType, seen);
  }
  return seen;
}

const plain = { longs: String, enums: String, arrays: true, defaults: true };

const { handle, reader } = await openIndexed(file);
const types = new Map();
for (const [id, schema] of reader.schemasById) {
  if (!schema.name.startsWith("foxglove.")) continue;
  const ours = typeOf(schema);
  const theirs = official.lookupType(schema.name);
  assert.deepEqual(declared(ours), declared(theirs), `schema ${schema.name} is not the official one`);
  types.set(id, { ours, theirs });
}

const topics = new Map();
const ticks = new Map();
const decoders = new Map();
for await (const message of reader.readMessages({ validateCrcs: true })) {
  const channel = reader.channelsById.get(message.channelId);
  const type = types.get(channel.schemaId);
  if (type) {
    const decoded = type.theirs.toObject(type.theirs.decode(message.data), plain);
    assert.deepEqual(decoded, type.ours.toObject(type.ours.decode(message.data), plain));
    const again = Buffer.from(type.theirs.encode(type.theirs.decode(message.data)).finish());
    assert.ok(again.equals(Buffer.from(message.data)), `${channel.topic}: the official schema writes it otherwise`);
    const { name } = reader.schemasById.get(channel.schemaId);
    if (!topics.has(channel.topic)) topics.set(channel.topic, { schema: name, messages: [] });
    topics.get(channel.topic).messages.push({ logTime: message.logTime, ...decoded });
  } else if (channel.topic === "/tick") {
    if (!decoders.has(channel.id)) decoders.set(channel.id, decoderOf(reader.schemasById.get(channel.schemaId)));
    ticks.set(message.logTime, decoders.get(channel.id)(message.data));
  }
}
const attached = [];
for await (const attachment of reader.readAttachments({ validateCrcs: true })) attached.push(attachment.name);
await handle.close();

const nanoseconds = ({ seconds, nanos }) => BigInt(seconds) * 1_000_000_000n + BigInt(nanos);
const of = (topic, schema) => {
  const found = topics.get(topic);
  assert.ok(found, `no topic ${topic}`);
  assert.equal(found.schema, schema, topic);
  return found.messages;
};

// Frames: every entity is in the one that the devices move in.
const devices = of("/device", "foxglove.FrameTransform");
for (const device of devices) {
  assert.equal(device.parent_frame_id, kFrame);
  assert.equal(nanoseconds(device.timestamp), device.logTime);
  const { x, y, z, w } = device.rotation;
  assert.ok(Math.abs(Math.hypot(x, y, z, w) - 1) < 1e-9, "no unit quaternion");
}
const scenes = of("/scene", "foxglove.SceneUpdate");
const arrows = of("/arrows", "foxglove.SceneUpdate");
for (const update of [...scenes, ...arrows]) {
  const ids = update.entities.map((entity) => entity.id);
  assert.equal(new Set(ids).size, ids.length, "two entities of one id");
  for (const entity of update.entities) assert.equal(entity.frame_id, kFrame);
}
const primitives = ["cubes", "spheres", "cylinders", "triangles"];
for (const scene of scenes) {
  for (const entity of scene.entities) assert.ok(primitives.some((kind) => entity[kind].length > 0), entity.id);
}

/// x of a pose's own frame.
function direction({ x, y, z, w }) {
  return [1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w)];
}

let drawn = 0;
function expectArrow(entity, force, where) {
  const [x = 0, y = 0, z = 0] = force;
  const norm = Math.hypot(x, y, z);
  assert.equal(entity.arrows.length, norm > 0 ? 1 : 0, where);
  if (norm === 0) return;
  const [arrow] = entity.arrows;
  assert.ok(Math.abs(arrow.shaft_length + arrow.head_length - kMetresPerNewton * norm) < 1e-12, where);
  direction(arrow.pose.orientation).forEach((number, axis) => {
    assert.ok(Math.abs(number - [x, y, z][axis] / norm) < 1e-6, where);
  });
  ++drawn;
}
if (!options.server) {
  for (const update of arrows) {
    const tick = ticks.get(update.logTime);
    assert.ok(tick, "arrows at a time without a tick");
    const entity = (name) => update.entities.find(({ id }) => id === `device: ${name}`);
    expectArrow(entity("displayed force"), tick.applied_N, `displayed force of tick ${tick.tick}`);
    expectArrow(entity("requested force"), tick.request_N, `requested force of tick ${tick.tick}`);
    expectArrow(entity("remote force"), tick.remote_N, `remote force of tick ${tick.tick}`);
  }
  assert.ok(drawn > 0, "no force is shown");
  const seconds = Number([...ticks.keys()].at(-1) - [...ticks.keys()][0]) / 1e9;
  assert.ok(devices.length <= 61 * (seconds + 1), "more than 60 pictures a second");
}

const sample = (messages) => {
  const fullest = messages.reduce((a, b) => (JSON.stringify(strip(b)).length > JSON.stringify(strip(a)).length ? b : a));
  return JSON.stringify(strip(fullest), (key, value) =>
    Array.isArray(value) && value.length > 12 ? [...value.slice(0, 3), `... ${value.length} in all`] : value, 1);
};
/// Without what is empty.
function strip(value) {
  if (Array.isArray(value)) return value.map(strip);
  if (typeof value === "bigint") return String(value);
  if (value === null || typeof value !== "object") return value;
  return Object.fromEntries(Object.entries(value).filter(([, one]) => !(Array.isArray(one) && one.length === 0))
    .map(([key, one]) => [key, strip(one)]));
}
for (const [topic, { schema, messages }] of [...topics].sort()) {
  console.log(`${topic} (${schema}), ${messages.length} messages, such as`);
  console.log(sample(messages));
}
const counts = [...topics].map(([topic, { messages }]) => `${messages.length} on ${topic}`).sort().join(", ");
console.log(`attached: ${attached.join(", ")}`);
console.log(`what the 3D panel shows is there: ${counts}; ${drawn} arrows are the forces of their ticks`);
