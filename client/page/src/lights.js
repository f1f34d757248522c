// For each track: its law, whether it is passive, and what it is doing. Never by colour alone.
import { byId, make, setText } from "./dom.js";
import { digits } from "./text.js";

const kLights = {
  true: { className: "good", sign: "✓", text: "Passive" },
  false: { className: "bad", sign: "✕", text: "Not passive" },
  null: { className: "unknown", sign: "–", text: "Not audited" },
};

const kLetters = ["A", "B"];

class Light {
  constructor(track) {
    this.sign = make("span", { className: "lamp", "aria-hidden": "true" });
    this.verdict = make("strong", { className: "verdict", role: "status" });
    this.law = make("span", { className: "law-name" });
    this.detail = make("span", { className: "detail" });
    this.letter = make("b", { className: `letter colour-track-${track}`, title: "this track's lines and tip" }, kLetters[track]);
    this.root = make("div", { className: "light unknown" }, this.sign,
      make("div", { className: "light-text" }, make("span", {}, this.letter, this.law), this.verdict, this.detail));
    this.root.dataset.track = String(track);
  }

  show(law, status, many) {
    const light = kLights[String(status?.passive ?? null)] ?? kLights.null;
    this.root.className = `light ${light.className}`;
    this.root.dataset.passive = String(status?.passive ?? null);
    this.letter.hidden = !many;
    setText(this.sign, light.sign);
    setText(this.law, law ?? "");
    setText(this.verdict, light.text);
    const state = status && status.state !== "connected" ? `${status.state} · ` : "";
    const robot = status?.robot ? `robot ${status.robot} · ` : "";
    const least = status?.least_passivity_mJ;
    setText(this.detail, state + robot + (least === null || least === undefined
      ? "nobody audits: the true energy is not known"
      : `least P ${digits(least)} mJ`));
  }
}

export class Lights {
  constructor() {
    this.area = byId("lights");
    this.lights = [];
    this.laws = [];
    this.states = [];
  }

  setTracks(tracks) {
    this.laws = tracks.map(({ law }) => law);
    while (this.lights.length > tracks.length) this.lights.pop().root.remove();
    while (this.lights.length < tracks.length) {
      const light = new Light(this.lights.length);
      this.lights.push(light);
      this.area.append(light.root);
    }
    this.states.length = tracks.length;
    this.#show();
  }

  show(track, status) {
    this.states[track] = status;
    this.#show();
  }

  #show() {
    this.lights.forEach((light, track) => light.show(this.laws[track], this.states[track], this.lights.length > 1));
  }
}
