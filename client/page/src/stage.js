// The scene in 3D: one view for each track, side by side on one canvas, with one camera for all.
import {
  AmbientLight, Box3, Color, DirectionalLight, DoubleSide, BackSide, GridHelper, Group, LineBasicMaterial, MeshLambertMaterial,
  PerspectiveCamera, Plane, Quaternion, Raycaster, Scene, Sphere, Vector2, Vector3, WebGLRenderer,
} from "three";
import { DeviceFrame } from "./frame.js";
import { ForceLabels } from "./labels.js";
import { Marks } from "./marks.js";
import { deform, makeMesh, makeShape, point } from "./shapes.js";
import { colours } from "./theme.js";

const kLeastRadius_m = 0.03;
const kMostRadius_m = 0.4;
const kArrowUnits = 15; // length of the longest arrow; in units of the marks
const kAskedMost_N = 50; // what a bound forbids may be a thousand times what is applied: longer arrows end there
// Of a robot: what of it is seen at first about its tool, and the marks' size beside that.
const kRobotRadius_m = 0.27;
const kRobotMiddle_m = [-0.07, 0, 0.13];
const kMarksOfRobot = 0.55;
const kForces_N = [1, 2, 5, 10, 20, 50, 100, 200, 500, 1000];
const kTorques_N_m = [0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50];

/** What the longest mark stands for: a round number, which fits the largest value of the last seconds. */
class RoundScale {
  constructor(steps) {
    this.steps = steps;
    this.reset();
  }

  reset() {
    this.full = this.steps[0];
    this.peak = 0;
  }

  add(value) {
    this.peak = Math.max(value, 0.993 * this.peak);
    const fits = this.steps.find((step) => step >= this.peak) ?? this.steps.at(-1);
    if (fits > this.full || this.peak < 0.4 * this.full) this.full = fits;
  }
}

/** Whether a processor draws in place of a graphics card. Asked on a canvas of its own: a canvas keeps its first answer. */
function drawsInSoftware() {
  const gl = document.createElement("canvas").getContext("webgl2");
  const facts = gl?.getExtension("WEBGL_debug_renderer_info");
  const name = facts ? gl.getParameter(facts.UNMASKED_RENDERER_WEBGL) : "";
  gl?.getExtension("WEBGL_lose_context")?.loseContext();
  return /swiftshader|llvmpipe|software/i.test(name);
}

/** @returns {WebGLRenderer|null} null where the browser has no WebGL */
function makeRenderer(canvas) {
  try {
    // Smooth edges take nearly half of the time that a processor has for a frame.
    return new WebGLRenderer({ canvas, antialias: !drawsInSoftware(), powerPreference: "high-performance" });
  } catch {
    return null;
  }
}

/** What a track is drawn from: the newest of its ticks. */
class TrackState {
  constructor() {
    this.tip = null;
    this.place = null;
    this.hand = null;
    this.plane = null;
    this.asked = new Vector3();
    this.applied = new Vector3();
    this.tool = null; // of a robot that follows, in the picture as are the two below
    this.exerted = new Vector3();
    this.exertedTorque = new Vector3();
    this.turn = null; // Quaternion of a handle that tells its orientation
    this.torque = new Vector3(); // on that handle
    this.lever = null; // from the grip to the tip of a tool, in the handle's axes
    this.frame = new DeviceFrame();
  }

  /** Of the device, where it touches: the tip of the tool that the scene puts into the hand, else the grip. */
  get touching() {
    if (!this.tip || !this.turn || !this.lever) return this.tip;
    return this.lever.clone().applyQuaternion(this.turn).add(this.tip);
  }

  /** The same, in the picture. */
  placed() {
    const { frame } = this;
    const place = (at) => (at ? frame.place(at) : null);
    return {
      tip: place(this.touching), grip: place(this.tip), place: place(this.place), hand: place(this.hand),
      turn: this.turn ? frame.turn.clone().multiply(this.turn) : null, torque: frame.direction(this.torque),
      tool: this.tool, exerted: this.exerted, exertedTorque: this.exertedTorque,
      plane: this.plane ? { middle: frame.place(this.plane.middle), normal: frame.direction(this.plane.normal) } : null,
      asked: frame.direction(this.asked), applied: frame.direction(this.applied),
    };
  }
}

/** One track: its scene and its marks. */
class View {
  constructor(track) {
    this.scene = new Scene();
    this.parts = new Group();
    this.marks = new Marks(track);
    this.state = new TrackState();
    this.bodies = new Map(); // name -> {position_m, orientation}: where each was told of last
    this.ground = null;
    const sun = new DirectionalLight(0xffffff, 2.2);
    sun.position.set(-0.5, -0.8, 1.4);
    this.scene.add(new AmbientLight(0xffffff, 1.25), sun, this.parts, this.marks);
  }
}

export class Stage {
  /** @param {HTMLCanvasElement} canvas @param {() => void} changed asks for a frame */
  constructor(canvas, changed) {
    this.canvas = canvas;
    this.changed = changed;
    this.renderer = makeRenderer(canvas);
    this.views = [];
    this.dof = 3;
    this.target = new Vector3();
    this.radius_m = 0.08;
    this.angles = { azimuth: 0, elevation: 0 };
    this.zoom = 1;
    this.forces = new RoundScale(kForces_N);
    this.torques = new RoundScale(kTorques_N_m);
    this.labels = new ForceLabels(canvas.parentElement);
    if (this.renderer) {
      this.renderer.setScissorTest(true);
      this.renderer.autoClear = false;
    }
    this.camera = new PerspectiveCamera(35, 1, 0.001, 20);
    this.camera.up.set(0, 0, 1);
    this.raycaster = new Raycaster();
    this.facing = new Plane();
    this.materials = {
      solid: new MeshLambertMaterial(),
      robot: new MeshLambertMaterial(),
      joint: new MeshLambertMaterial(),
      floor: new MeshLambertMaterial(),
      inside: new MeshLambertMaterial({ side: BackSide }),
      sheet: new MeshLambertMaterial({ side: DoubleSide }),
      soft: new MeshLambertMaterial({ side: DoubleSide, polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1 }),
      edges: new LineBasicMaterial({ transparent: true, opacity: 0.45 }),
    };
    this.resetCamera();
    this.paint();
    canvas.addEventListener("webglcontextrestored", changed);
  }

  /** Whether it can be seen. Without WebGL all else works: the hand takes hold of a tip that is not drawn. */
  get usable() {
    return this.renderer !== null;
  }

  /** One to three axes, and one or two tracks. */
  setTracks(count, dof) {
    while (this.views.length > count) this.views.pop();
    while (this.views.length < count) {
      const view = new View(this.views.length);
      view.message = this.views[0]?.message ?? null;
      this.views.push(view);
    }
    if (this.dof !== dof) {
      this.dof = dof;
      this.resetCamera();
    }
    this.paint();
    this.#resizeMarks();
    this.changed();
  }

  /** Takes a scene; also the same one again, when more of it is known. */
  setScene(track, message) {
    if (!this.views[track]) return;
    const view = this.views[track];
    const other = view.message?.name !== message.name;
    view.message = message;
    view.state.frame = new DeviceFrame();
    view.state.lever = message.tool_m ? point(message.tool_m) : null;
    if (!message.robot) view.state.tool = null;
    if (other) view.bodies.clear();
    this.#placeFrame(view);
    if (track !== 0) {
      this.#build(view);
    } else {
      this.#look(message);
      if (other) {
        this.forces.reset();
        this.torques.reset();
        this.labels.hide();
        this.resetCamera();
      }
      for (const each of this.views) this.#build(each);
    }
    this.changed();
  }

  /** What is seen at first. Of a robot, as soon as it is known where its tool is. */
  #look(message) {
    const { robot } = message;
    const tool = robot ? this.views[0].state.tool : null;
    if (robot) {
      this.radius_m = kRobotRadius_m;
      this.target.copy(tool ?? point([0.5, 0, 0])).add(point(kRobotMiddle_m));
      return;
    }
    const extent = this.#extentOf(message);
    this.target.copy(extent.around);
    this.radius_m = extent.radius_m;
  }

  #extentOf(message) {
    const box = new Box3();
    const extent = { radius_m: 0.06, around: new Vector3(), dof: this.dof };
    const parts = new Group();
    for (const shape of message.shapes) {
      const made = makeShape(shape, extent, this.materials);
      if (made && !made.userData.endless) parts.add(made);
    }
    for (const mesh of message.meshes) parts.add(makeMesh(mesh, this.materials));
    box.setFromObject(parts);
    dispose(parts);
    if (box.isEmpty()) {
      if (message.shapes[0]) extent.around.copy(point(message.shapes[0].through_m));
      return extent;
    }
    const sphere = box.getBoundingSphere(new Sphere());
    extent.around.copy(sphere.center);
    extent.radius_m = Math.min(Math.max(sphere.radius * 0.92, kLeastRadius_m), kMostRadius_m);
    return extent;
  }

  #build(view) {
    dispose(view.parts);
    view.parts.clear();
    const extent = { radius_m: this.radius_m, around: this.target, dof: this.dof };
    const robots = view.message?.robot?.solids ?? 0; // the first ones are the robot's
    (view.message?.shapes ?? []).forEach((shape, i) => {
      const joint = shape.kind === "cylinder" || shape.kind === "sphere";
      const solid = i >= robots ? this.materials.solid : joint ? this.materials.joint : this.materials.robot;
      const made = makeShape(shape, extent, this.materials, solid);
      if (made) view.parts.add(made);
    });
    for (const mesh of view.message?.meshes ?? []) view.parts.add(makeMesh(mesh, this.materials));
    for (const [name, body] of view.bodies) placeBody(view, name, body);
    if (view.ground) {
      view.scene.remove(view.ground);
      view.ground.dispose();
    }
    const step = 10 ** Math.floor(Math.log10(this.radius_m / 2));
    const cells = 2 * Math.ceil((2.2 * this.radius_m) / step);
    view.ground = new GridHelper(cells * step, cells, colours.grid, colours.grid);
    view.ground.rotateX(Math.PI / 2);
    const low = this.dof < 3 ? -0.13 * this.radius_m : this.#lowest(view) - 0.01 * this.radius_m;
    view.ground.position.set(this.target.x, this.target.y, this.dof === 1 ? -0.55 * this.radius_m : low);
    view.scene.add(view.ground);
    this.#resizeMarks();
  }

  #lowest(view) {
    const box = new Box3();
    for (const part of view.parts.children) box.expandByObject(part);
    return box.isEmpty() ? this.target.z - 0.4 * this.radius_m : Math.min(box.min.z, this.target.z);
  }

  moved(track, message) {
    const view = this.views[track];
    if (!view) return;
    for (const mesh of message.meshes ?? []) {
      const part = view.parts.getObjectByName(mesh.name);
      if (part) deform(part, mesh.vertices_m, this.materials);
    }
    for (const body of message.bodies ?? []) {
      view.bodies.set(body.name, body);
      placeBody(view, body.name, body);
    }
    this.#placeFrame(view);
    if (message.values) this.#showRobot(view, message.values);
    this.changed();
  }

  /** Of a shape that is the device's frame. */
  #placeFrame(view) {
    const shape = view.message?.shapes?.find(({ kind }) => kind === "frame");
    const body = shape && view.bodies.get(shape.name);
    if (!body) return;
    const { frame } = view.state;
    const [w, x, y, z] = body.orientation;
    frame.position.copy(point(body.position_m));
    frame.turn.set(x, y, z, w);
    frame.scale = shape.scale || 1;
  }

  /** Where the tool is, and what it exerts. */
  #showRobot(view, values) {
    const { state } = view;
    const first = state.tool === null;
    state.tool = new Vector3(values.tool_x_m, values.tool_y_m, values.tool_z_m);
    state.exerted.set(values.force_x_N, values.force_y_N, values.force_z_N);
    state.exertedTorque.set(values.torque_x_N_m ?? 0, values.torque_y_N_m ?? 0, values.torque_z_N_m ?? 0);
    if (first && view === this.views[0] && view.message?.robot) {
      this.#look(view.message);
      this.resetCamera();
      for (const each of this.views) this.#build(each);
    }
    this.forces.add(state.exerted.length());
    if (state.turn) this.torques.add(state.exertedTorque.length());
  }

  /** The newest tick of a `ticks` message. */
  show(track, message) {
    const view = this.views[track];
    const last = message.time_s.length - 1;
    if (!view || last < 0) return;
    const { state } = view;
    const newest = (values) => (values?.[last] ? point(values[last]) : null);
    state.tip = newest(message.position_m);
    state.place = newest(message.place_m);
    state.asked = newest(message.asked_N) ?? new Vector3();
    state.applied = newest(message.applied_N) ?? new Vector3();
    const [w, x, y, z] = message.orientation ?? [];
    state.turn = message.orientation ? new Quaternion(x, y, z, w) : null;
    state.torque.copy(point(message.torque_N_m));
    state.hand = message.hand_m ? point(message.hand_m) : null;
    state.plane = message.plane && message.contact?.[last]
      ? { middle: point(message.plane.point_m), normal: point(message.plane.normal).normalize() } : null;
    this.forces.add(Math.max(Math.min(state.asked.length(), kAskedMost_N), state.applied.length()));
    this.torques.add(state.torque.length());
    this.#keepInSight(this.tip(track));
    this.changed();
  }

  /** What is thrown about stays in the picture: the camera goes back, up to a limit. */
  #keepInSight(tip) {
    // A robot's tip is somewhere else until it is told where the device's frame is.
    if (!tip || (this.views[0].message?.robot && !this.views[0].state.tool)) return;
    const away = tip.distanceTo(this.target);
    const seen = this.radius_m / this.zoom;
    if (away < 0.95 * seen) return;
    this.zoom = Math.min(this.zoom, Math.max(this.radius_m / (1.1 * away), 0.6));
  }

  paint() {
    this.back = new Color(colours["view-back"]);
    this.materials.robot.color.set(colours.robot);
    this.materials.joint.color.set(colours["robot-joint"]);
    for (const name of ["solid", "inside", "sheet"]) this.materials[name].color.set(colours.solid);
    this.materials.floor.color.set(colours.floor);
    this.materials.soft.color.set(colours.soft);
    this.materials.edges.color.set(colours["solid-edge"]);
    for (const view of this.views) {
      view.marks.paint();
      this.#build(view);
    }
    this.changed();
  }

  #resizeMarks() {
    for (const view of this.views) view.marks.resize((view.message?.robot ? kMarksOfRobot : 1) * this.radius_m);
  }

  resetCamera() {
    this.angles = { 1: { azimuth: -0.25, elevation: 0.25 }, 2: { azimuth: 0, elevation: 1.25 } }[this.dof] ??
      { azimuth: -0.45, elevation: 0.38 };
    // From beside the robot and a little behind it, where its tool is not hidden.
    if (this.views[0]?.message?.robot) this.angles = { azimuth: -0.6, elevation: 0.22 };
    this.zoom = 1;
    this.changed();
  }

  /** Turns the camera [rad]. */
  orbit(right, up) {
    this.angles = {
      azimuth: this.angles.azimuth - right,
      elevation: Math.min(Math.max(this.angles.elevation + up, -1.5), 1.5),
    };
    this.changed();
  }

  /** Brings the camera nearer by this factor. */
  zoomBy(factor) {
    this.zoom = Math.min(Math.max(this.zoom * factor, 0.15), 8);
    this.changed();
  }

  /** The part of the canvas for a view, from its lower left [CSS pixels]. */
  #frame(index) {
    const { clientWidth, clientHeight } = this.canvas;
    const width = clientWidth / this.views.length;
    return { x: index * width, y: 0, width, height: clientHeight };
  }

  #aim(aspect) {
    const { azimuth, elevation } = this.angles;
    const half = Math.atan(Math.tan((this.camera.fov * Math.PI) / 360) * Math.min(1, aspect));
    const distance = (0.98 * this.radius_m) / Math.sin(half) / this.zoom;
    this.camera.aspect = aspect;
    this.camera.position.set(
      this.target.x + distance * Math.sin(azimuth) * Math.cos(elevation),
      this.target.y - distance * Math.cos(azimuth) * Math.cos(elevation),
      this.target.z + distance * Math.sin(elevation));
    this.camera.lookAt(this.target);
    this.camera.near = distance / 50;
    this.camera.far = distance * 20;
    this.camera.updateProjectionMatrix();
    this.camera.updateMatrixWorld();
  }

  /** The index of the view under a place on the screen. */
  viewAt(clientX) {
    const box = this.canvas.getBoundingClientRect();
    const part = (clientX - box.left) / box.width;
    return Math.min(Math.max(Math.floor(part * this.views.length), 0), this.views.length - 1);
  }

  /** Where a track's tip is in the picture, or null. */
  tip(index) {
    const state = this.views[index]?.state;
    return state?.tip ? state.frame.place(state.tip) : null;
  }

  /** Where the device's frame is in the picture now. */
  frameOf(index) {
    return this.views[index].state.frame.clone();
  }

  /** Where a point of the scene is on the screen [CSS pixels of the window]. */
  onScreen(index, place) {
    const frame = this.#frame(index);
    const box = this.canvas.getBoundingClientRect();
    this.#aim(frame.width / frame.height);
    const seen = place.clone().project(this.camera);
    return {
      x: box.left + frame.x + ((seen.x + 1) / 2) * frame.width,
      y: box.bottom - frame.y - ((seen.y + 1) / 2) * frame.height,
    };
  }

  /** The point under a place on the screen, on the plane through `through` that faces the camera; null beside it. */
  pointAt(index, clientX, clientY, through) {
    const frame = this.#frame(index);
    const box = this.canvas.getBoundingClientRect();
    this.#aim(frame.width / frame.height);
    this.raycaster.setFromCamera(new Vector2(
      ((clientX - box.left - frame.x) / frame.width) * 2 - 1,
      ((box.bottom - clientY - frame.y) / frame.height) * 2 - 1), this.camera);
    const normal = this.camera.getWorldDirection(new Vector3());
    if (this.dof === 1) normal.setX(0).normalize(); // the plane that has the axis in it
    if (this.dof === 2) normal.set(0, 0, 1);
    this.facing.setFromNormalAndCoplanarPoint(normal, through);
    return this.raycaster.ray.intersectPlane(this.facing, new Vector3());
  }

  /** Draws all views. */
  render() {
    const { clientWidth: width, clientHeight: height } = this.canvas;
    if (!this.usable || width === 0 || height === 0) return;
    const ratio = Math.min(window.devicePixelRatio || 1, 2);
    if (this.renderer.getPixelRatio() !== ratio) this.renderer.setPixelRatio(ratio);
    const size = this.renderer.getSize(new Vector2());
    if (size.x !== width || size.y !== height) this.renderer.setSize(width, height, false);
    this.views.forEach((view, index) => {
      const frame = this.#frame(index);
      this.#aim(frame.width / frame.height);
      const placed = view.state.placed();
      const scales = { unitsPerN: kArrowUnits / this.forces.full, longest: kArrowUnits, fullTorque_N_m: this.torques.full };
      view.marks.show(placed, this.camera.getWorldQuaternion(new Quaternion()), scales);
      this.renderer.setViewport(frame.x, frame.y, frame.width, frame.height);
      this.renderer.setScissor(frame.x, frame.y, frame.width, frame.height);
      this.renderer.setClearColor(this.back);
      this.renderer.clear();
      this.renderer.render(view.scene, this.camera);
      if (index === 0 && view.message?.robot) this.#label(placed, frame);
    });
  }

  /** The forces of hand and robot in newtons, beside their arrows; the camera is aimed. */
  #label(placed, frame) {
    const onArea = (place) => {
      const seen = place.clone().project(this.camera);
      return { x: frame.x + ((seen.x + 1) / 2) * frame.width, y: ((1 - seen.y) / 2) * frame.height };
    };
    const unit_m = this.views[0].marks.unit_m;
    const label = (name, at, force) => {
      if (!at) return;
      const arrow = force.clone().multiplyScalar((unit_m * kArrowUnits) / this.forces.full).clampLength(0, unit_m * kArrowUnits);
      this.labels.show(name, force.length(), onArea(at), onArea(arrow.add(at)));
    };
    label("applied", placed.tip, placed.applied);
    label("exerted", placed.tool, placed.exerted);
  }
}

function placeBody(view, name, { position_m, orientation: [w, x, y, z] }) {
  const part = view.parts.getObjectByName(name);
  if (!part) return;
  part.position.copy(point(position_m));
  part.quaternion.set(x, y, z, w);
}

function dispose(group) {
  group.traverse((part) => part.geometry?.dispose());
}
