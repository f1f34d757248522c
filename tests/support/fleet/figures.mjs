// Reads what stand_in.mjs wrote of servers that each take one client and end after it: their lives as figures, and as
// WRONG lines what must not be.
//
//   node figures.mjs FILE.jsonl SERVERS
import fs from "node:fs";

const [file, servers] = process.argv.slice(2);
const lines = fs.readFileSync(file, "utf8").trim().split("\n").map((line) => JSON.parse(line));
const lives = new Map();
for (const line of lines.filter((each) => each.server)) {
  if (!lives.has(line.server)) lives.set(line.server, []);
  lives.get(line.server).push(line);
}

const wrong = [];
const waits_ms = [];
const stays_s = [];
for (const [name, life] of lives) {
  const at = (holds) => life.filter(holds);
  const given = at((each) => each.event === "allocated by the allocator");
  const counted = at((each) => each.event === "count" && each.count === 1);
  const ended = at((each) => each.to === "Shutdown");
  if (given.length !== 1) wrong.push(`${name} was given to ${given.length} clients`);
  if (counted.length !== 1) wrong.push(`${name} had ${counted.length} sessions`);
  if (ended.length !== 1) wrong.push(`${name} shut down ${ended.length} times`);
  if (at((each) => each.to === "Unhealthy").length > 0) wrong.push(`${name} was unhealthy`);
  if (given.length !== 1 || counted.length !== 1 || ended.length !== 1) continue;
  waits_ms.push(1000 * (counted[0].time_s - given[0].time_s));
  stays_s.push(ended[0].time_s - counted[0].time_s);
}
if (lives.size !== Number(servers)) wrong.push(`${lives.size} servers were heard of, ${servers} were started`);

const at = (values, share) => values.sort((a, b) => a - b)[Math.min(values.length - 1, Math.floor(share * values.length))];
const row = (what, value) => console.log(`  ${what.padEnd(40)} ${value}`);
row("given out, used once, shut down", `${waits_ms.length}`);
if (waits_ms.length > 0) {
  row("from the allocator to the first session", `median ${at(waits_ms, 0.5).toFixed(0)} ms, longest ${at(waits_ms, 1).toFixed(0)} ms`);
}
row("requests that the stand-in refused", `${lines.filter((each) => each.event === "refused").length}`);
wrong.forEach((each) => console.log(`  WRONG: ${each}`));
