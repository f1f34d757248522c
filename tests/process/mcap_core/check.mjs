// Opens a recording with the official MCAP reader, by its index and as a stream, and finds every tick.
//
//   node check.mjs RECORDING.mcap [--truth TRUTH.jsonl] [--summary SUMMARY.json]
//
// Compares each message with its line in TRUTH, and the number of ticks with SUMMARY's.
import assert from "node:assert/strict";
import { existsSync } from "node:fs";
import { readFile } from "node:fs/promises";
import { parseArgs } from "node:util";

import { core, decoderOf, decompressHandlers, openIndexed } from "./recording.mjs";

const { positionals, values: options } = parseArgs({
  allowPositionals: true,
  options: { truth: { type: "string" }, summary: { type: "string" } },
});
const [file] = positionals;
assert.ok(file && existsSync(file), `no such recording: '${file}'`);

async function messagesByIndex(path) {
  const { handle, reader } = await openIndexed(path);
  const decoders = new Map([...reader.schemasById].map(([id, schema]) => [id, decoderOf(schema)]));
  const topics = new Map();
  for await (const message of reader.readMessages({ validateCrcs: true })) {
    const channel = reader.channelsById.get(message.channelId);
    if (!topics.has(channel.topic)) topics.set(channel.topic, []);
    topics.get(channel.topic).push({ logTime: message.logTime, ...decoders.get(channel.schemaId)(message.data) });
  }
  const metadata = new Map();
  for await (const entry of reader.readMetadata()) metadata.set(entry.name, entry.metadata);
  await handle.close();
  return { topics, metadata, statistics: reader.statistics, channels: reader.channelsById };
}

async function countByStream(path) {
  const reader = new core.McapStreamReader({ validateCrcs: true, decompressHandlers });
  reader.append(await readFile(path));
  let messages = 0n;
  for (let record; (record = reader.nextRecord()); ) if (record.type === "Message") ++messages;
  assert.ok(reader.done(), "the file is not complete");
  return messages;
}

/// Every field that `expected` has, exactly: both sides are doubles, or integers as text.
function contains(actual, expected, where) {
  for (const [name, value] of Object.entries(expected)) {
    const found = actual[name] ?? actual[name.replace(/_(.)/g, (_, letter) => letter.toUpperCase())];
    const nested = value !== null && typeof value === "object" && !Array.isArray(value);
    if (nested) contains(found, value, `${where}.${name}`);
    else assert.deepEqual(found, value, `${where}.${name}`);
  }
}

const indexed = await messagesByIndex(file);
const ticks = indexed.topics.get("/tick") ?? [];
assert.ok(ticks.length > 0, "no /tick message");
ticks.forEach((tick, i) => assert.equal(tick.tick, String(i + 1), "a tick is missing"));
assert.equal(await countByStream(file), indexed.statistics.messageCount);
for (const [id, count] of indexed.statistics.channelMessageCounts) {
  assert.equal(BigInt(indexed.topics.get(indexed.channels.get(id).topic).length), count);
}
assert.ok(indexed.metadata.get("forcebound.run")?.get("law"), "no metadata 'forcebound.run' with a law");
assert.ok(indexed.metadata.has("forcebound.totals"), "no metadata 'forcebound.totals'");
const epoch = BigInt(indexed.metadata.get("forcebound.run").get("epoch_ns"));
for (const tick of ticks) assert.equal(tick.logTime, epoch + BigInt(tick.timeNs ?? tick.time_ns));

if (options.truth) {
  const seen = new Map();
  for (const line of (await readFile(options.truth, "utf8")).trim().split("\n")) {
    const { topic, ...expected } = JSON.parse(line);
    const i = seen.get(topic) ?? 0;
    seen.set(topic, i + 1);
    contains(indexed.topics.get(topic)[i], expected, `${topic}[${i}]`);
  }
  for (const [topic, count] of seen) assert.equal(indexed.topics.get(topic).length, count);
}
if (options.summary) assert.equal(ticks.length, JSON.parse(await readFile(options.summary, "utf8")).ticks);

const counts = [...indexed.topics].map(([topic, messages]) => `${messages.length} on ${topic}`).join(", ");
console.log(`the official reader finds every tick: ${counts}`);
