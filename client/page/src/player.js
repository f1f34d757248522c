// A recording: its time as a slider, played or stopped.
import { byId, setText } from "./dom.js";
import { runTime } from "./text.js";

export class Player {
  /** @param {(message: object) => void} send */
  constructor(send) {
    this.send = send;
    this.playing = true;
    this.slider = byId("time");
    this.held = false;
    byId("play").addEventListener("click", () => this.#play(!this.playing));
    byId("speed").addEventListener("change", () => this.#play(this.playing));
    this.slider.addEventListener("pointerdown", () => (this.held = true));
    for (const end of ["pointerup", "pointercancel"]) this.slider.addEventListener(end, () => (this.held = false));
    this.slider.addEventListener("input", () => {
      const time_s = this.slider.valueAsNumber;
      this.#showTime(time_s);
      this.send({ kind: "seek", time_s });
    });
  }

  #play(on) {
    this.playing = on;
    this.send({ kind: "play", on, speed: Number(byId("speed").value) });
    this.#showState();
  }

  #showState() {
    setText(byId("play"), this.playing ? "Stop" : "Play");
  }

  show(hello) {
    if (typeof hello.playing === "boolean") this.playing = hello.playing;
    this.slider.max = String(hello.duration_s ?? 0);
    this.duration_s = hello.duration_s ?? 0;
    this.#showTime(hello.time_s ?? 0);
    this.#showState();
  }

  /** Time of the newest tick. */
  at(time_s) {
    if (this.held) return;
    this.slider.value = String(time_s);
    this.#showTime(time_s);
  }

  #showTime(time_s) {
    const text = `${runTime(time_s)} of ${runTime(this.duration_s)}`;
    setText(byId("time-text"), text);
    this.slider.setAttribute("aria-valuetext", text);
  }
}
