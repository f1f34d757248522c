// Stands in for Agones: the sidecar beside each of some servers, and the allocator for all of them, by the same REST
// requests and answers (agones.dev: Client SDKs, REST; Allocator Service). It starts no servers and ends none: it keeps
// their states, and writes each request that changes one, or that is wrong, as a line of JSON on stdout.
//
//   node stand_in.mjs [--servers N] [--first-port UDP-PORT] [--sidecar-port PORT] [--allocator-port PORT]
//                     [--no-counters] [--deaf] [--odd-looks N] [--health-period SECONDS] [--tls-folder FOLDER]
//
// Server I of N is said to be at 127.0.0.1:(UDP-PORT + I); its sidecar listens on PORT + I, or a free port for 0. With a
// folder that has ca.pem, server.pem and server-key.pem the allocator speaks TLS and wants a certificate of that
// authority. --deaf: connections are taken, and never answered. --odd-looks: the first N times that a server is asked for, it
// has no state.
import fs from "node:fs";
import http from "node:http";
import https from "node:https";
import { parseArgs } from "node:util";

const { values } = parseArgs({
  options: {
    servers: { type: "string", default: "1" },
    "first-port": { type: "string", default: "47800" },
    "sidecar-port": { type: "string", default: "0" },
    "allocator-port": { type: "string", default: "0" },
    "no-counters": { type: "boolean", default: false },
    "odd-looks": { type: "string", default: "0" },
    deaf: { type: "boolean", default: false },
    "health-period": { type: "string", default: "5" },
    "tls-folder": { type: "string" },
  },
});

const kHost = "127.0.0.1";
const kFailuresMost = 3; // as a Fleet's health.failureThreshold
const begun = Date.now();
const say = (line) => process.stdout.write(JSON.stringify({ time_s: (Date.now() - begun) / 1000, ...line }) + "\n");

// Of each server, what Agones keeps of its GameServer.
const servers = Array.from({ length: Number(values.servers) }, (_, index) => ({
  name: `forcebound-${index}`,
  port: Number(values["first-port"]) + index,
  state: "Scheduled",
  counters: values["no-counters"] ? {} : { sessions: { count: 0, capacity: 0 } },
  healthy: 0,
  looks: 0,
  heard: Date.now(),
}));

const failure = (status, code, message) => ({ status, body: { code, message, details: [] } });
const good = (body = {}) => ({ status: 200, body });

function turn(server, state, why) {
  const before = server.state;
  server.state = state;
  say({ server: server.name, event: why, from: before, to: state });
  return good();
}

// GameServers that shut down or are unhealthy do not come back.
const isGone = (server) => server.state === "Shutdown" || server.state === "Unhealthy";

function update(server, name, body) {
  const counter = server.counters[name];
  if (!counter) return failure(404, 5, `counter not found: ${name}`);
  const whole = (text) => typeof text === "string" && /^[0-9]+$/.test(text);
  if (!whole(body.count) || !whole(body.capacity)) return failure(400, 3, "count and capacity must be int64 as text");
  if (Number(body.count) > Number(body.capacity)) return failure(400, 11, "out of range: count is above capacity");
  Object.assign(counter, { count: Number(body.count), capacity: Number(body.capacity) });
  say({ server: server.name, event: "count", count: counter.count, capacity: counter.capacity });
  return good({ name, ...body });
}

const shown = (server) => ({
  object_meta: { name: server.name, namespace: "default", labels: { "agones.dev/fleet": "forcebound" } },
  spec: { health: { disabled: false, period_seconds: Number(values["health-period"]), failure_threshold: kFailuresMost } },
  status: { state: server.state, address: kHost, ports: [{ name: "forcebound", port: server.port }] },
});

function answer_of_sidecar(server, method, path, text) {
  if (method === "GET" && path === "/gameserver") return good(++server.looks > Number(values["odd-looks"]) ? shown(server) : {});
  let body;
  try {
    body = JSON.parse(text);
  } catch {
    return failure(400, 3, "the body is no JSON");
  }
  const counter = /^\/v1beta1\/counters\/([a-z]+)$/.exec(path);
  if (method === "PATCH" && counter) return update(server, counter[1], body);
  if (method !== "POST") return failure(404, 5, "Not Found");
  if (isGone(server)) return failure(500, 2, `the GameServer is in state ${server.state}`);
  switch (path) {
    case "/ready":
      return turn(server, "Ready", "ready");
    case "/allocate":
      return turn(server, "Allocated", "allocate");
    case "/shutdown":
      return turn(server, "Shutdown", "shutdown");
    case "/health":
      server.heard = Date.now();
      if (server.healthy++ === 0) say({ server: server.name, event: "first health" });
      return good();
    default:
      return failure(404, 5, "Not Found");
  }
}

// The first server that a selector takes; selectors are tried one after the other.
function chosen_by(selectors) {
  for (const selector of selectors) {
    const fleet = selector.matchLabels?.["agones.dev/fleet"] ?? "forcebound";
    const state = selector.gameServerState === "ALLOCATED" ? "Allocated" : "Ready";
    const least = Number(selector.counters?.sessions?.minAvailable ?? 0);
    const free = (server) => (server.counters.sessions?.capacity ?? 0) - (server.counters.sessions?.count ?? 0);
    const found = servers.find((each) => fleet === "forcebound" && each.state === state && free(each) >= least);
    if (found) return found;
  }
  return undefined;
}

function answer_of_allocator(method, path, text) {
  if (method !== "POST" || path !== "/gameserverallocation") return failure(404, 5, "Not Found");
  let body;
  try {
    body = JSON.parse(text);
  } catch {
    return failure(400, 3, "the body is no JSON");
  }
  const server = body.namespace === "default" && chosen_by(body.gameServerSelectors ?? [{}]);
  if (!server) {
    say({ event: "nothing to allocate" });
    return failure(429, 8, "there is no available GameServer to allocate");
  }
  const counter = server.counters.sessions;
  if (body.counters?.sessions?.action === "Increment" && counter) {
    counter.count = Math.min(counter.count + Number(body.counters.sessions.amount), counter.capacity);
  }
  turn(server, "Allocated", "allocated by the allocator");
  return good({
    gameServerName: server.name,
    ports: [{ name: "metrics", port: 47880 }, { name: "forcebound", port: server.port }],
    address: kHost,
    nodeName: "this-machine",
    source: "local",
  });
}

function serve(answer_of, requested_port, tls) {
  const take = (request, response) => {
    if (values.deaf) return;
    const pieces = [];
    request.on("data", (piece) => pieces.push(piece));
    request.on("end", () => {
      const { status, body } = answer_of(request.method, request.url, Buffer.concat(pieces).toString());
      if (status !== 200) say({ event: "refused", request: `${request.method} ${request.url}`, status, why: body.message });
      response.writeHead(status, { "Content-Type": "application/json" });
      response.end(JSON.stringify(body));
    });
  };
  const service = tls ? https.createServer(tls, take) : http.createServer(take);
  return new Promise((resolve) => service.listen(requested_port, kHost, 511, () => resolve(service.address().port)));
}

const first = Number(values["sidecar-port"]);
const ports = [];
for (const [index, server] of servers.entries()) {
  ports.push(await serve((...request) => answer_of_sidecar(server, ...request), first === 0 ? 0 : first + index));
}
const folder = values["tls-folder"];
const tls = folder && {
  ca: fs.readFileSync(`${folder}/ca.pem`),
  cert: fs.readFileSync(`${folder}/server.pem`),
  key: fs.readFileSync(`${folder}/server-key.pem`),
  requestCert: true,
  rejectUnauthorized: true,
};
const allocator = await serve(answer_of_allocator, Number(values["allocator-port"]), tls);
say({ event: "listening", sidecars: ports, allocator });

// As Agones does: who says nothing for some periods is unhealthy.
setInterval(() => {
  for (const server of servers) {
    const silent_s = (Date.now() - server.heard) / 1000;
    const used = server.state === "Ready" || server.state === "Allocated";
    if (used && silent_s > kFailuresMost * Number(values["health-period"])) turn(server, "Unhealthy", "no health");
  }
}, 500);
