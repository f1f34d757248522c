// Checks the manifests of a folder: each against the schema of its kind, and all against each other and the server's
// options. Then breaks them in ways that have to be found. One line for each fault; exit code 1 if there is one, 77 if
// the packages are missing.
//
//   node check.mjs FOLDER FORCEBOUND-SERVER       (packages in ./node_modules)
//
// Kinds of Kubernetes: the schemas of npm's kubernetes-models, made from the API's own description. Kinds of Agones: with
// FORCEBOUND_AGONES_INSTALL=install.yaml the schemas in there, which know no GameServerAllocation; without it what is
// checked against the others below, and no more.
import { execFileSync } from "node:child_process";
import fs from "node:fs";
import { createRequire } from "node:module";
import path from "node:path";

const require = createRequire(path.join(process.cwd(), "package.json"));
let YAML, Ajv, models;
try {
  YAML = require("yaml");
  Ajv = require("ajv");
  models = {
    "networking.k8s.io/v1 NetworkPolicy": require("kubernetes-models/networking.k8s.io/v1/NetworkPolicy").NetworkPolicy,
    "policy/v1 PodDisruptionBudget": require("kubernetes-models/policy/v1/PodDisruptionBudget").PodDisruptionBudget,
    "apps/v1 DaemonSet": require("kubernetes-models/apps/v1/DaemonSet").DaemonSet,
    "v1 Pod": require("kubernetes-models/v1/Pod").Pod,
  };
} catch (error) {
  console.log(`SKIPPED: npm's packages are missing: ${error.message.split("\n")[0]}`);
  process.exit(77);
}

const [folder, server] = process.argv.slice(2);
const agones = process.env.FORCEBOUND_AGONES_INSTALL;

// A schema of the API as a JSON schema. Objects take no keys that it does not name: the API drops these silently.
function strict(schema) {
  if (Array.isArray(schema)) return schema.map(strict);
  if (schema === null || typeof schema !== "object") return schema;
  const copy = Object.fromEntries(Object.entries(schema).map(([key, value]) => [key, strict(value)]));
  if (copy.properties && copy.additionalProperties === undefined && !schema["x-kubernetes-preserve-unknown-fields"]) {
    copy.additionalProperties = false;
  }
  // In OpenAPI 3.0 it says of the minimum beside it that it is excluded; in JSON schemas it is a number.
  if (copy.exclusiveMinimum === true) copy.exclusiveMinimum = copy.minimum;
  if (typeof copy.exclusiveMinimum === "boolean") delete copy.exclusiveMinimum;
  return copy;
}

function schemas_of_agones() {
  if (!agones) return {};
  const found = {};
  for (const document of YAML.parseAllDocuments(fs.readFileSync(agones, "utf8"))) {
    const definition = document.toJS();
    if (definition?.kind !== "CustomResourceDefinition") continue;
    for (const { name, schema } of definition.spec.versions) {
      const { spec } = schema.openAPIV3Schema.properties;
      found[`${definition.spec.group}/${name} ${definition.spec.names.kind}`] = strict(spec);
    }
  }
  return found;
}

const agones_schemas = schemas_of_agones();
const ajv = new Ajv({ strict: false, allErrors: true, validateFormats: false });
const compiled = new Map();

function faults_of_kind(manifest) {
  const kind = `${manifest.apiVersion} ${manifest.kind}`;
  if (models[kind]) {
    try {
      new models[kind](manifest).validate();
      return [];
    } catch (error) {
      return [`${manifest.kind}: ${error.message}`];
    }
  }
  const schema = agones_schemas[kind];
  if (!schema) return [];
  if (!compiled.has(kind)) compiled.set(kind, ajv.compile(schema));
  const fits = compiled.get(kind);
  return fits(manifest.spec) ? [] : fits.errors.map((each) => `${manifest.kind}: spec${each.instancePath}: ${each.message}`);
}

const options = new Set(execFileSync(server, ["--help"], { encoding: "utf8" }).match(/--[a-z-]+/g));

// What has to agree between the files.
function faults_between(all) {
  const faults = [];
  const expect = (holds, what) => holds || faults.push(what);
  const fleet = all.fleet;
  const spec = fleet.spec.template.spec;
  const pod = spec.template.spec;
  const container = pod.containers.find(({ name }) => name === spec.container);
  expect(container, `Fleet: no container '${spec.container}'`);
  if (!container) return faults;
  const args = container.args;
  const value_of = (option) => args[args.indexOf(option) + 1];
  for (const arg of args.filter((each) => each.startsWith("--"))) expect(options.has(arg), `Fleet: the server has no ${arg}`);
  const port_of = (address) => Number(address.split(":").at(-1));
  const port = spec.ports.find(({ name }) => name === "forcebound");
  expect(port?.protocol === "UDP", "Fleet: no UDP port 'forcebound', which clients ask for");
  expect(port?.containerPort === port_of(value_of("--listen")), "Fleet: containerPort is not --listen's");
  const metrics = container.ports.find(({ name }) => name === "metrics");
  expect(metrics?.containerPort === port_of(value_of("--page")), "Fleet: the port of metrics is not --page's");
  expect(spec.counters?.sessions?.capacity === Number(value_of("--sessions-max")), "Fleet: counter is not --sessions-max");
  expect(pod.terminationGracePeriodSeconds > Number(value_of("--drain")), "Fleet: the pod is killed before --drain is over");
  expect(pod.securityContext.runAsNonRoot === true && pod.securityContext.runAsUser > 0, "Fleet: runs as root");
  // Files of a secret are root's: a user without rights reads them as one of fsGroup alone, and the server reads no key
  // that others may read as well.
  const keys = container.volumeMounts.find(({ mountPath }) => mountPath === path.posix.dirname(value_of("--key")));
  const secret = pod.volumes.find(({ name }) => name === keys?.name)?.secret;
  expect(path.posix.dirname(value_of("--clients")) === keys?.mountPath, "Fleet: --clients is not where the keys are mounted");
  expect(pod.securityContext.fsGroup > 0, "Fleet: no fsGroup, so that the server cannot read its keys");
  expect((secret?.defaultMode & 0o077) === 0o040, "Fleet: the mode of the keys lets in others than fsGroup, or not that");
  expect(container.securityContext.capabilities.drop.includes("ALL"), "Fleet: keeps capabilities that it does not need");
  const { requests, limits } = container.resources;
  expect(JSON.stringify(requests) === JSON.stringify(limits), "Fleet: requests are not the limits: no processor of its own");
  expect(/^[1-9][0-9]*$/.test(requests.cpu), "Fleet: cpu is no whole number: no processor of its own");
  expect(spec.eviction.safe === "Never", "Fleet: may be evicted in use");
  const labels = spec.template.metadata.labels;
  const selects = (selector) => Object.entries(selector).every(([key, value]) => labels[key] === value);
  expect(selects(all.policy.spec.podSelector.matchLabels), "NetworkPolicy: not of the fleet's pods");
  expect(selects(all.disruption.spec.selector.matchLabels), "PodDisruptionBudget: not of the fleet's pods");
  expect(all.disruption.spec.maxUnavailable === 0, "PodDisruptionBudget: lets sessions be evicted");
  const opened = all.policy.spec.ingress.flatMap(({ ports }) => ports).map(({ protocol, port: number }) => protocol + number);
  expect(opened.includes(`UDP${port?.containerPort}`), "NetworkPolicy: the clients' port is closed");
  expect(opened.includes(`TCP${metrics?.containerPort}`), "NetworkPolicy: the port of metrics is closed");
  expect(all.autoscaler.spec.fleetName === fleet.metadata.name, "FleetAutoscaler: not of the fleet");
  const { bufferSize, minReplicas, maxReplicas } = all.autoscaler.spec.policy.buffer;
  expect(bufferSize <= minReplicas && minReplicas <= maxReplicas, "FleetAutoscaler: bufferSize <= min <= max does not hold");
  for (const selector of all.allocation.spec.selectors) {
    expect(selector.matchLabels["agones.dev/fleet"] === fleet.metadata.name, "GameServerAllocation: not of the fleet");
    expect(["Ready", "Allocated"].includes(selector.gameServerState), "GameServerAllocation: unknown gameServerState");
    for (const name of Object.keys(selector.counters ?? {})) expect(spec.counters[name], `GameServerAllocation: no counter ${name}`);
  }
  expect(all.tuning.spec.template.spec.nodeSelector && Object.keys(pod.nodeSelector).every((key) => key in all.tuning.spec.template.spec.nodeSelector),
    "DaemonSet: tunes other nodes than the fleet's");
  expect(all.kubelet.cpuManagerPolicy === "static", "KubeletConfiguration: processors are shared");
  const pod_alone = { apiVersion: "v1", kind: "Pod", metadata: { name: "server", labels }, spec: pod };
  return [...faults, ...faults_of_kind(pod_alone)];
}

// By version 1.1, as Kubernetes reads it: 0440 is octal there.
const read = (name) => YAML.parse(fs.readFileSync(path.join(folder, `${name}.yaml`), "utf8"), { version: "1.1" });
const manifests = () => ({
  fleet: read("fleet"),
  autoscaler: read("autoscaler"),
  allocation: read("allocation"),
  policy: read("network-policy"),
  disruption: read("disruption"),
  tuning: read("node-tuning"),
  kubelet: read("kubelet"),
});
const faults_of = (all) => [...Object.values(all).flatMap(faults_of_kind), ...faults_between(all)];

const container_of = (all) => all.fleet.spec.template.spec.template.spec.containers[0];
const pod_of = (all) => all.fleet.spec.template.spec.template.spec;
const breaks = [
  ["a mistyped option", (all) => container_of(all).args.push("--sesions-max")],
  ["another port", (all) => (all.fleet.spec.template.spec.ports[0].containerPort = 1)],
  ["a short grace period", (all) => (all.fleet.spec.template.spec.template.spec.terminationGracePeriodSeconds = 30)],
  ["root", (all) => (all.fleet.spec.template.spec.template.spec.securityContext.runAsUser = 0)],
  ["keys that all may read", (all) => (pod_of(all).volumes[0].secret.defaultMode = 0o444)],
  ["keys of root alone", (all) => (pod_of(all).volumes[0].secret.defaultMode = 0o400)],
  ["no group for the keys", (all) => delete pod_of(all).securityContext.fsGroup],
  ["keys mounted elsewhere", (all) => (container_of(all).volumeMounts[0].mountPath = "/keys")],
  ["half a processor", (all) => (container_of(all).resources.requests.cpu = "500m")],
  ["a text for a number in the pod", (all) => (container_of(all).ports[0].containerPort = "x")],
  ["an unknown policy type", (all) => (all.policy.spec.policyTypes = "Ingress")],
  ["a closed port", (all) => all.policy.spec.ingress.shift()],
  ["a budget of others", (all) => (all.disruption.spec.selector.matchLabels.app = "other")],
  ["an autoscaler of others", (all) => (all.autoscaler.spec.fleetName = "other")],
  ["an allocation of others", (all) => (all.allocation.spec.selectors[0].matchLabels["agones.dev/fleet"] = "other")],
  ["a DaemonSet without selector", (all) => delete all.tuning.spec.selector],
];
if (agones) {
  breaks.push(["an unknown scheduling", (all) => (all.fleet.spec.scheduling = "Any")]);
  breaks.push(["a mistyped key", (all) => (all.autoscaler.spec.polici = {})]);
}

const faults = faults_of(manifests());
for (const [what, damage] of breaks) {
  const broken = manifests();
  damage(broken);
  if (faults_of(broken).length === 0) faults.push(`not found: ${what}`);
}
faults.forEach((fault) => console.log(fault));
console.log(`7 manifests, ${breaks.length} ways to break them, ${faults.length} faults; kinds of Agones ` +
  (agones ? `against the schemas of ${path.basename(agones)}` : "without their schemas (FORCEBOUND_AGONES_INSTALL)"));
process.exit(faults.length === 0 ? 0 : 1);
