// The pointer, the finger and the arrow keys as the hand; and what turns the camera.
import { Vector3 } from "three";

const kNear_px = 48;
const kStepOfRadius = 0.04;

const turns = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };
const steps = {
  1: { ArrowLeft: [-1, 0, 0], ArrowRight: [1, 0, 0], ArrowDown: [-1, 0, 0], ArrowUp: [1, 0, 0] },
  2: { ArrowLeft: [-1, 0, 0], ArrowRight: [1, 0, 0], ArrowUp: [0, 1, 0], ArrowDown: [0, -1, 0] },
  3: {
    ArrowLeft: [-1, 0, 0], ArrowRight: [1, 0, 0], ArrowUp: [0, 0, 1], ArrowDown: [0, 0, -1],
    PageUp: [0, 1, 0], PageDown: [0, -1, 0],
  },
};

/**
 * Left button or one finger: the hand. Right button, with Shift, or two fingers: the camera. Wheel or pinch: nearer.
 *
 * @param {HTMLElement} area takes the focus
 * @param {import("./stage.js").Stage} stage
 * @param {{send: (message: object) => void, allowed: () => boolean}} program
 */
export function attachHand(area, stage, program) {
  const pointers = new Map(); // id -> {x, y}
  let drag = null; // {id, view, through, offset, frame}
  let hand = null; // Vector3 of the arrow keys, in the device's frame
  let pending = null;

  /** @param {Vector3} place in the device's frame */
  const sendHand = (place) => {
    // One message for each frame at most: the newest place counts.
    if (!pending) {
      window.requestAnimationFrame(() => {
        if (pending) program.send({ kind: "hand", point_m: pending });
        pending = null;
      });
    }
    pending = place.toArray().slice(0, stage.dof);
  };
  const letGo = () => {
    drag = null;
    hand = null;
    pending = null;
    area.classList.remove("dragging");
    program.send({ kind: "hand_free" });
  };

  const begin = (event) => {
    const view = stage.viewAt(event.clientX);
    const tip = stage.tip(view);
    if (!tip || !program.allowed()) return;
    const through = tip.clone();
    const under = stage.pointAt(view, event.clientX, event.clientY, through);
    const seen = stage.onScreen(view, through);
    // Who takes hold of the tip beside its middle does not pull at it yet.
    const near = Math.hypot(seen.x - event.clientX, seen.y - event.clientY) < kNear_px;
    // The frame stays as it is now, where a robot's clutch moves it: else the hand would run after it.
    const frame = stage.frameOf(view);
    drag = { id: event.pointerId, view, frame, through, offset: near && under ? through.clone().sub(under) : new Vector3() };
    hand = null;
    area.classList.add("dragging");
    pull(event);
  };
  const pull = (event) => {
    const under = stage.pointAt(drag.view, event.clientX, event.clientY, drag.through);
    if (under) sendHand(drag.frame.deviceOf(under.add(drag.offset)));
  };

  area.addEventListener("pointerdown", (event) => {
    area.focus({ preventScroll: true });
    area.setPointerCapture(event.pointerId);
    pointers.set(event.pointerId, { x: event.clientX, y: event.clientY });
    if (pointers.size > 1) {
      if (drag) letGo();
    } else if (event.button === 0 && !event.shiftKey) {
      begin(event);
    }
  });
  area.addEventListener("pointermove", (event) => {
    const last = pointers.get(event.pointerId);
    if (!last) return;
    if (drag?.id === event.pointerId) {
      pull(event);
    } else if (pointers.size === 2) {
      const [other] = [...pointers.entries()].filter(([id]) => id !== event.pointerId).map(([, place]) => place);
      const before = Math.hypot(last.x - other.x, last.y - other.y);
      const now = Math.hypot(event.clientX - other.x, event.clientY - other.y);
      if (before > 10 && now > 10) stage.zoomBy(now / before);
      stage.orbit((event.clientX - last.x) / 300, (event.clientY - last.y) / 300);
    } else {
      stage.orbit((event.clientX - last.x) / 150, (event.clientY - last.y) / 150);
    }
    last.x = event.clientX;
    last.y = event.clientY;
  });
  for (const end of ["pointerup", "pointercancel", "lostpointercapture"]) {
    area.addEventListener(end, (event) => {
      pointers.delete(event.pointerId);
      if (drag?.id === event.pointerId) letGo();
    });
  }
  area.addEventListener("contextmenu", (event) => event.preventDefault());
  area.addEventListener("wheel", (event) => {
    event.preventDefault();
    stage.zoomBy(Math.exp(-event.deltaY / 800));
  }, { passive: false });

  area.addEventListener("keydown", (event) => {
    if (event.altKey || event.ctrlKey || event.metaKey) return;
    const turn = event.shiftKey && turns[event.key];
    const step = !event.shiftKey && steps[stage.dof]?.[event.key];
    if (turn) {
      stage.orbit(turn[0] * 0.08, turn[1] * 0.08);
    } else if (step) {
      const tip = stage.tip(0);
      if (!tip || !program.allowed()) return;
      const frame = stage.frameOf(0);
      hand = (hand ?? frame.deviceOf(tip)).addScaledVector(new Vector3(...step), (kStepOfRadius * stage.radius_m) / frame.scale);
      sendHand(hand);
    } else if (event.key === "Escape") {
      letGo();
    } else if (event.key === "+" || event.key === "-") {
      stage.zoomBy(event.key === "+" ? 1.1 : 1 / 1.1);
    } else if (event.key === "0") {
      stage.resetCamera();
    } else {
      return;
    }
    event.preventDefault();
  });
}
