// Where the device's frame is in the picture: the same frame, but where a robot follows, whose world is the picture's.
import { Quaternion, Vector3 } from "three";

/** picture = position + scale * turn(device) */
export class DeviceFrame {
  constructor() {
    this.position = new Vector3();
    this.turn = new Quaternion();
    this.scale = 1;
  }

  clone() {
    const copy = new DeviceFrame();
    copy.position.copy(this.position);
    copy.turn.copy(this.turn);
    copy.scale = this.scale;
    return copy;
  }

  /** @returns {Vector3} a place of the device in the picture */
  place(ofDevice) {
    return ofDevice.clone().multiplyScalar(this.scale).applyQuaternion(this.turn).add(this.position);
  }

  /** @returns {Vector3} a direction or force of the device in the picture */
  direction(ofDevice) {
    return ofDevice.clone().applyQuaternion(this.turn);
  }

  /** @returns {Vector3} a place of the picture in the device's frame */
  deviceOf(place) {
    return place.clone().sub(this.position).applyQuaternion(this.turn.clone().invert()).divideScalar(this.scale);
  }
}
