// What is drawn at the device: its tip, the place that the newest force is for, the forces, the contact plane, the hand.
import {
  BufferAttribute, BufferGeometry, ConeGeometry, CylinderGeometry, DoubleSide, GreaterDepth, Group, Line, LineBasicMaterial,
  LineDashedMaterial, LineLoop, Mesh, MeshBasicMaterial, MeshLambertMaterial, Quaternion, RingGeometry, SphereGeometry,
  BoxGeometry, TorusGeometry, Vector3,
} from "three";
import { colours } from "./theme.js";

/** Units of the marks in the radius of the scene. */
export const kUnitsInRadius = 18;

const kUp = new Vector3(0, 1, 0);
const kForward = new Vector3(0, 0, 1);
const direction = new Vector3();

/** Over everything else, so that nothing hides it. */
function above(material, order) {
  material.depthTest = false;
  material.depthWrite = false;
  material.transparent = true;
  material.userData.order = order;
  return material;
}

/** An arrow of length 1 along y before it is turned and stretched. */
class Arrow extends Group {
  constructor(thick, opacity, order) {
    super();
    this.material = above(new MeshBasicMaterial({ opacity }), order);
    this.shaft = new Mesh(new CylinderGeometry(thick, thick, 1, 16).translate(0, 0.5, 0), this.material);
    this.head = new Mesh(new ConeGeometry(2.6 * thick, 6 * thick, 20).translate(0, -3 * thick, 0), this.material);
    this.headLength = 6 * thick;
    this.shaft.renderOrder = order;
    this.head.renderOrder = order;
    this.add(this.shaft, this.head);
  }

  /** @param {Vector3} vector in units of the marks */
  show(vector) {
    const length = vector.length();
    this.visible = length > 0.05;
    if (!this.visible) return;
    this.quaternion.setFromUnitVectors(kUp, direction.copy(vector).divideScalar(length));
    const head = Math.min(1, length / (1.6 * this.headLength));
    this.head.scale.setScalar(head);
    this.head.position.y = length;
    this.shaft.scale.y = Math.max(length - 0.9 * head * this.headLength, 1e-3);
  }
}

const kArcs = 12;
const kArcRadius = 3.6;

/** A torque as a round arrow about its axis, z before it is turned: the longer, the larger. Right-handed. */
class TorqueArc extends Group {
  constructor(order) {
    super();
    this.material = above(new MeshBasicMaterial(), order);
    const parts = Array.from({ length: kArcs }, (_, i) => ((i + 1) * 1.8 * Math.PI) / kArcs);
    this.arcs = parts.map((angle) => {
      const arc = new Group();
      const head = new Mesh(new ConeGeometry(0.75, 1.7, 16).translate(0, 0.4, 0), this.material);
      head.position.set(kArcRadius * Math.cos(angle), kArcRadius * Math.sin(angle), 0);
      head.rotation.z = angle;
      arc.add(new Mesh(new TorusGeometry(kArcRadius, 0.24, 8, 48, angle), this.material), head);
      for (const part of arc.children) part.renderOrder = order;
      return arc;
    });
    this.add(...this.arcs);
  }

  /** @param {number} full torque of the longest arc */
  show(torque, full) {
    const size = torque.length();
    this.visible = size > full / (2 * kArcs);
    if (!this.visible) return;
    const shown = Math.min(Math.round((size / full) * kArcs), kArcs) - 1;
    this.arcs.forEach((arc, i) => (arc.visible = i === Math.max(shown, 0)));
    this.quaternion.setFromUnitVectors(kForward, direction.copy(torque).divideScalar(size));
  }
}

/** What the hand holds of a device that turns: a pen along z of the handle, with a fin along x that shows its roll. */
function makeHandle(material) {
  const handle = new Group();
  const pen = new Mesh(new CylinderGeometry(0.55, 0.32, 7, 20).translate(0, 3.5, 0).rotateX(Math.PI / 2), material);
  const fin = new Mesh(new BoxGeometry(1.6, 0.3, 2).translate(1, 0, 5.5), material);
  handle.add(pen, fin);
  return handle;
}

function lineOfTwo(material, order) {
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(new Float32Array(6), 3));
  const line = new Line(geometry, above(material, order));
  line.frustumCulled = false;
  line.renderOrder = order;
  return line;
}

function setEnds(line, from, to) {
  const position = line.geometry.getAttribute("position");
  position.setXYZ(0, from.x, from.y, from.z);
  position.setXYZ(1, to.x, to.y, to.z);
  position.needsUpdate = true;
  if (line.material.isLineDashedMaterial) line.computeLineDistances();
}

/** The marks of one track. Lengths are in units of a part of the scene's radius, by the scale of each part. */
export class Marks extends Group {
  constructor(track) {
    super();
    this.track = track;
    this.tip = new Mesh(new SphereGeometry(1, 32, 20), new MeshLambertMaterial());
    // The tip's part behind a surface: it sinks into what is soft, or far away.
    this.tipBehind = new Mesh(this.tip.geometry, new MeshBasicMaterial({
      transparent: true, opacity: 0.45, depthFunc: GreaterDepth, depthWrite: false }));
    this.tipBehind.renderOrder = 5;
    this.place = new Mesh(new TorusGeometry(1.25, 0.14, 8, 40), above(new MeshBasicMaterial(), 7));
    this.place.renderOrder = 7;
    this.behind = lineOfTwo(new LineBasicMaterial(), 6);
    this.asked = new Arrow(0.5, 0.75, 8);
    this.applied = new Arrow(0.26, 1, 9);
    this.exerted = new Arrow(0.4, 0.9, 8); // by a robot, at its tool
    this.solid = new MeshLambertMaterial();
    this.handle = makeHandle(this.solid);
    this.rod = new Mesh(new CylinderGeometry(0.3, 0.3, 1, 16).translate(0, 0.5, 0), this.solid); // from grip to tip, along y
    this.torque = new TorqueArc(9);
    this.exertedTorque = new TorqueArc(8);
    this.spring = lineOfTwo(new LineDashedMaterial(), 6);
    this.hand = new Mesh(new RingGeometry(0.75, 1.1, 4), above(new MeshBasicMaterial({ side: DoubleSide }), 7));
    this.hand.renderOrder = 7;
    this.plane = new Group();
    this.disc = new Mesh(new RingGeometry(0, 1, 48), new MeshBasicMaterial({
      side: DoubleSide, transparent: true, opacity: 0.28, depthWrite: false }));
    this.disc.renderOrder = 4;
    const circle = Array.from({ length: 48 }, (_, i) => new Vector3(Math.cos((i * Math.PI) / 24), Math.sin((i * Math.PI) / 24), 0));
    this.circle = new LineLoop(new BufferGeometry().setFromPoints(circle), above(new LineBasicMaterial(), 4));
    this.plane.add(this.disc, this.circle);
    this.add(this.tip, this.tipBehind, this.place, this.behind, this.asked, this.applied, this.exerted, this.spring, this.hand, this.plane,
      this.handle, this.rod, this.torque, this.exertedTorque);
    this.unit_m = 0.002;
    this.vector = new Vector3();
    this.visible = false;
  }

  paint() {
    const own = colours[`track-${this.track}`] || colours["track-0"];
    for (const mark of [this.tip, this.tipBehind]) mark.material.color.set(own);
    for (const mark of [this.place, this.behind]) mark.material.color.set(colours.text);
    this.asked.material.color.set(colours.asked);
    for (const mark of [this.applied, this.torque]) mark.material.color.set(colours.applied);
    for (const mark of [this.exerted, this.exertedTorque]) mark.material.color.set(colours.exerted);
    this.solid.color.set(own);
    for (const mark of [this.spring, this.hand]) mark.material.color.set(colours.hand);
    for (const mark of [this.disc, this.circle]) mark.material.color.set(colours.plane);
  }

  /** @param {number} radius_m of the scene, of what the device reaches where that is less */
  resize(radius_m) {
    this.unit_m = radius_m / kUnitsInRadius;
    for (const mark of [this.tip, this.tipBehind, this.place, this.hand, this.asked, this.applied, this.exerted, this.handle,
      this.rod, this.torque, this.exertedTorque]) {
      mark.scale.setScalar(this.unit_m);
    }
    this.plane.scale.setScalar(0.3 * radius_m);
    this.spring.material.dashSize = 0.8 * this.unit_m;
    this.spring.material.gapSize = 0.5 * this.unit_m;
  }

  /**
   * @param {object} state newest of the track, as vectors
   * @param {Quaternion} facing turns what faces the camera
   * @param {{unitsPerN: number, longest: number, fullTorque_N_m: number}} scales of the arrows, the longest in units
   */
  show(state, facing, { unitsPerN, longest, fullTorque_N_m }) {
    this.visible = state.tip !== null || state.tool !== null;
    this.exerted.visible = state.tool !== null;
    if (state.tool) {
      this.exerted.position.copy(state.tool);
      this.exerted.show(this.vector.copy(state.exerted).multiplyScalar(unitsPerN).clampLength(0, longest));
    }
    this.#showTurn(state, fullTorque_N_m);
    const ofDevice = [this.tip, this.tipBehind, this.place, this.behind, this.asked, this.applied, this.spring, this.hand, this.plane];
    for (const mark of ofDevice) mark.visible = state.tip !== null;
    if (state.tip === null) return;
    for (const mark of [this.tip, this.tipBehind, this.asked, this.applied]) mark.position.copy(state.tip);
    this.place.visible = state.place !== null;
    this.behind.visible = this.place.visible;
    if (state.place) {
      this.place.position.copy(state.place);
      this.place.quaternion.copy(facing);
      setEnds(this.behind, state.tip, state.place);
    }
    this.asked.show(this.vector.copy(state.asked).multiplyScalar(unitsPerN).clampLength(0, longest));
    this.applied.show(this.vector.copy(state.applied).multiplyScalar(unitsPerN).clampLength(0, longest));
    this.hand.visible = state.hand !== null;
    this.spring.visible = this.hand.visible;
    if (state.hand) {
      this.hand.position.copy(state.hand);
      this.hand.quaternion.copy(facing);
      setEnds(this.spring, state.grip, state.hand);
    }
    this.plane.visible = state.plane !== null;
    if (state.plane) {
      const { middle, normal } = state.plane;
      // Where the tip would lie on it.
      const away = this.vector.copy(state.tip).sub(middle).dot(normal);
      this.plane.position.copy(state.tip).addScaledVector(normal, -away);
      this.plane.quaternion.setFromUnitVectors(kForward, normal);
    }
  }

  /** Of a handle that tells its orientation: itself, the tool, and torques, of which no other device knows. */
  #showTurn({ grip, tip, turn, torque, tool, exertedTorque }, full_N_m) {
    const turned = grip !== null && turn !== null;
    for (const mark of [this.handle, this.rod, this.torque, this.exertedTorque]) mark.visible = turned;
    if (!turned) return;
    this.handle.position.copy(grip);
    this.handle.quaternion.copy(turn);
    this.torque.position.copy(grip);
    this.torque.show(torque, full_N_m);
    const length_m = tip.distanceTo(grip);
    this.rod.visible = length_m > 0;
    if (this.rod.visible) {
      this.rod.position.copy(grip);
      this.rod.quaternion.setFromUnitVectors(kUp, direction.copy(tip).sub(grip).divideScalar(length_m));
      this.rod.scale.y = length_m;
    }
    this.exertedTorque.visible = tool !== null;
    if (tool === null) return;
    this.exertedTorque.position.copy(tool);
    this.exertedTorque.show(exertedTorque, full_N_m);
  }
}
