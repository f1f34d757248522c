// The live page: takes what the program says and shows it; draws only when something changed.
import shippedScenes from "shipped-scenes";
import { Charts } from "./charts.js";
import { byId, onResize, setText } from "./dom.js";
import { Events, say } from "./events.js";
import { attachHand } from "./hand.js";
import { placeHelp } from "./help.js";
import { Latency } from "./latency.js";
import { Lights } from "./lights.js";
import { openLink } from "./link.js";
import { Pipes } from "./pipes.js";
import { Player } from "./player.js";
import { Sessions } from "./sessions.js";
import { Robot } from "./robot.js";
import { Settings } from "./settings.js";
import { Stage } from "./stage.js";
import { digits, duration } from "./text.js";
import { onTheme, watchTheme } from "./theme.js";

watchTheme();
placeHelp();

/** Parts that wait to be drawn in the next frame. */
const waiting = new Set();
let asked = false;
const frames = { count: 0, since: performance.now() };

function wants(part) {
  waiting.add(part);
  if (asked || document.hidden) return;
  asked = true;
  window.requestAnimationFrame(drawFrame);
}

function drawFrame() {
  asked = false;
  const now = new Set(waiting);
  waiting.clear();
  if (now.has("stage")) stage.render();
  if (now.has("charts")) charts.draw();
  if (now.has("pipes") && pipes.draw()) wants("pipes");
  ++frames.count;
}
document.addEventListener("visibilitychange", () => {
  if (!document.hidden) for (const part of ["stage", "charts", "pipes"]) wants(part);
});

const send = (message) => link.send(message);
const stage = new Stage(byId("canvas"), () => wants("stage"));
const charts = new Charts(() => wants("charts"));
const pipes = new Pipes(() => wants("pipes"));
const latency = new Latency();
const lights = new Lights();
const events = new Events();
const settings = new Settings(send);
const sessions = new Sessions(send);
const player = new Player(send);
const robot = new Robot();
let hello = null;
const scenes = [];

byId("no-webgl").hidden = stage.usable;
byId("canvas").hidden = !stage.usable;
byId("legend").hidden = !stage.usable;
onResize(byId("view"), () => wants("stage"));
onTheme(() => {
  stage.paint();
  latency.draw();
  wants("pipes");
});
attachHand(byId("view"), stage, { send, allowed: handIsOurs });

/** Whether the program follows the pointer. */
function handIsOurs() {
  return Boolean(hello && hello.pointer && !hello.read_only);
}

const holdButton = byId("hold-button");
function pressButton(down) {
  if (holdButton.classList.contains("down") === down) return;
  holdButton.classList.toggle("down", down);
  send({ kind: "button", index: 0, down });
}
holdButton.addEventListener("pointerdown", () => pressButton(true));
for (const end of ["pointerup", "pointercancel", "pointerleave", "blur", "keyup"]) {
  holdButton.addEventListener(end, () => pressButton(false));
}
holdButton.addEventListener("keydown", (event) => {
  if (event.key === " " || event.key === "Enter") pressButton(true);
});
byId("view").addEventListener("keydown", (event) => {
  if (event.key === " " && !holdButton.hidden) {
    pressButton(true);
    event.preventDefault();
  }
});
byId("view").addEventListener("keyup", (event) => {
  if (event.key === " ") pressButton(false);
});
byId("record").addEventListener("click", () => send({ kind: "record", on: !hello?.recording }));
byId("reset-view").addEventListener("click", () => stage.resetCamera());

const kSceneComes_ms = 1500;

/** What a hello without them stands for. */
const kNothingKnown = { choices: { laws: [], scenes: [], devices: [] }, settings: {}, tracks: [], may_change: false, read_only: false };

function showHello(message) {
  const other = hello && (hello.settings?.scene !== message.settings?.scene || hello.settings?.device !== message.settings?.device);
  hello = { ...kNothingKnown, ...message };
  const { program } = hello;
  document.body.dataset.program = program;
  document.body.dataset.tracks = String(hello.tracks.length);
  document.title = `Forcebound ${program}`;
  setText(byId("program"), { client: "Client", server: "Server", view: "Recording" }[program] ?? program);
  setText(byId("version"), hello.version ?? "");
  const live = hello.tracks.length > 0;
  for (const id of ["scene", "charts", "network", "latency"]) byId(id).hidden = !live;
  byId("settings").hidden = program !== "client";
  byId("sessions").hidden = program !== "server";
  byId("player").hidden = program !== "view";
  byId("record").hidden = program !== "client" || hello.read_only;
  byId("record").setAttribute("aria-pressed", String(Boolean(hello.recording)));
  setText(byId("record-text"), hello.recording ? "Stop recording" : "Record");
  // The end of a path is what tells recordings apart.
  setText(byId("record-file"), (hello.recording ?? "").split("/").at(-1));
  byId("record-file").title = hello.recording ?? "";
  byId("hints").hidden = !live || !handIsOurs();
  holdButton.hidden = !handIsOurs();
  if (live) {
    if (other) {
      charts.clear();
      robot.clear();
      scenes.length = 0; // until it is told
    }
    charts.setUp({ period_s: hello.period_s || 0.001, dof: hello.dof || 3, tracks: hello.tracks.length });
    stage.setTracks(hello.tracks.length, hello.dof || 3);
    lights.setTracks(hello.tracks, handIsOurs() ? "your" : "the");
  }
  settings.show(hello);
  expectScene();
  if (program === "view") player.show(hello);
}

function showScene(message) {
  const track = message.track ?? 0;
  scenes[track] = message;
  if (track === 0) showRobot(message);
  stage.setScene(track, { ...message, shapes: message.shapes ?? [], meshes: message.meshes ?? [] });
  const more = message.more ? ` (${message.more})` : "";
  setText(byId("scene-title"), message.name ? `scene: ${message.name}${more}` : "");
}

/** A robot at the far end: its panel, and what the marks mean then. */
function showRobot(message) {
  if (message.robot) {
    robot.setFacts(message.robot);
  } else {
    robot.clear();
  }
  byId("legend-exerted").hidden = !message.robot;
  setText(holdButton, message.robot ? "Clutch" : "Device button");
  holdButton.title = `the device's button, ${message.robot ? "pressed: the robot stays where it is" : "to grasp"}; also the space bar in the scene`;
  setText(byId("legend-applied"), message.robot ? "force on the hand" : "force applied");
  setText(byId("legend-tip"), message.robot ? "where the hand wants the tool" : "tip");
  // A server's own page has no track but shows its robot.
  const ofHand = hello?.tracks.length > 0;
  for (const part of document.querySelectorAll("#legend .of-hand")) part.hidden = !ofHand;
  if (message.robot && !ofHand) {
    byId("scene").hidden = false;
    stage.setTracks(1, 3);
  }
}

/** Where the program does not tell its scene, as with remote rendering, one that ships is drawn as it ships. */
function expectScene() {
  window.clearTimeout(expectScene.waiting);
  expectScene.waiting = window.setTimeout(() => {
    const name = hello.settings.scene;
    if (hello.tracks.length === 0 || (scenes[0] && (!name || scenes[0].name === name))) return;
    const shipped = shippedScenes[name];
    const note = shipped ? "drawn as it ships" : "its shapes are not known here";
    const more = [note, shipped?.more].filter(Boolean).join("; ");
    hello.tracks.forEach((_, track) => showScene({ track, name, shapes: shipped?.shapes ?? [], more }));
  }, kSceneComes_ms);
}

const kinds = {
  hello: showHello,
  scene: showScene,
  moved: (message) => {
    stage.moved(message.track ?? 0, message);
    if ((message.track ?? 0) === 0 && message.values) robot.set({ values: message.values });
  },
  ticks: (message) => {
    if (!hello || !message.time_s?.length) return;
    charts.add(message.track ?? 0, message);
    stage.show(message.track ?? 0, message);
    setText(byId("arrow-scale"), `longest: ${stage.forces.full} N`);
    showTorque(message);
    if (hello.program === "view") player.at(message.time_s.at(-1));
  },
  status: (message) => {
    lights.show(message.track ?? 0, message);
    if ((message.track ?? 0) !== 0) return;
    pipes.show(message.network, hello?.settings?.network);
    latency.show(message.stages_ms);
    showTick(message.tick);
    if (message.robot) {
      robot.set({ leader: message.state, hand_N: stage.views[0]?.state.applied.length(), ...(robot.present ? {} : { state: message.robot }) });
    }
  },
  event: (message) => events.add(message, hello?.tracks.length ?? 1),
  refused: (message) => {
    say(message.text ?? `refused: ${message.about}`);
    if (hello) settings.show(hello);
  },
  sessions: (message) => sessions.show(message, hello?.read_only ?? false),
};

/** Of a handle that tells its orientation: what the round arrow stands for. */
function showTorque({ orientation, torque_N_m: torque }) {
  byId("legend-torque").hidden = !orientation;
  if (torque) setText(byId("torque-scale"), `${digits(Math.hypot(...torque))} N m; full circle: ${stage.torques.full} N m`);
}

function showTick(tick) {
  byId("tick").hidden = !tick?.period_us;
  if (!tick?.period_us) return;
  const late = tick.late ? `, ${tick.late} late` : "";
  const dropped = tick.dropped_for_page ? `, ${tick.dropped_for_page} not shown here` : "";
  setText(byId("tick"), `Tick ${digits(tick.period_us.median / 1000)} ms${late}${dropped}`);
}

let lostTimer = 0;
function showLink(state) {
  document.body.dataset.link = state.open ? "open" : "lost";
  window.clearInterval(lostTimer);
  setText(byId("link"), state.open ? "Connected" : state.ever ? "Not connected" : "Connecting");
  byId("lost").hidden = state.open;
  if (state.open || !state.lostSince) return;
  const since = state.lostSince.toTimeString().slice(0, 8);
  const why = state.reason ? ` (${state.reason})` : "";
  const show = () => {
    const ago = duration((Date.now() - state.lostSince.getTime()) / 1000);
    setText(byId("lost-text"), state.ever
      ? `Connection lost${why} at ${since}, ${ago} ago. What is shown is from then; the page tries again by itself.`
      : `No connection${why} since ${since}. Is the program running, and is this the address that it printed? The page tries again by itself.`);
  };
  show();
  lostTimer = window.setInterval(show, 1000);
}

const link = openLink({
  message: (message) => kinds[message.kind]?.(message),
  changed: showLink,
});

/** Frames drawn, for who measures the page. */
window.forcebound = { frames, stage, charts, robot };
