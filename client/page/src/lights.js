// For each track: its law, whether it is passive, and what it is doing. Never by colour alone.
import { byId, make, setText } from "./dom.js";
import { helpButton } from "./help.js";
import { digits } from "./text.js";

/** Sign and verdict, and what it means, `whose` hand and the least P in words. */
const kLights = {
  untouched: { className: "unknown", sign: "–", text: "Not touched yet",
    means: () => "No force was asked for so far: there is nothing to judge." },
  true: { className: "good", sign: "✓", text: "Passive", means: (whose) => `The device has given ${whose} hand no energy.` },
  false: { className: "bad", sign: "✕", text: "Not passive",
    means: (whose, least) => `Its motors have given ${whose} hand up to ${least} more than its damping took.` },
  null: { className: "unknown", sign: "–", text: "Not audited",
    means: () => "Nobody audits this device: its true energy is not known." },
};

function lightOf(status) {
  const passive = status?.passive ?? null;
  return passive === true && status.touched === false ? "untouched" : String(passive);
}

const kLetters = ["A", "B"];

class Light {
  constructor(track) {
    this.sign = make("span", { className: "lamp", "aria-hidden": "true" });
    this.verdict = make("strong", { className: "verdict", role: "status" });
    this.law = make("span", { className: "law-name" });
    this.detail = make("span", { className: "detail" });
    this.help = helpButton("passivity");
    this.means = make("span", { className: "means" });
    this.letter = make("b", { className: `letter colour-track-${track}`, title: "this track's lines and tip" }, kLetters[track]);
    this.root = make("div", { className: "light unknown" }, this.sign,
      make("div", { className: "light-text" }, make("span", {}, this.letter, this.law), this.verdict,
        make("span", { className: "details" }, this.detail, this.help), this.means));
    this.root.dataset.track = String(track);
  }

  show(law, status, many, whose) {
    const light = kLights[lightOf(status)];
    this.root.className = `light ${light.className}`;
    this.root.dataset.passive = String(status?.passive ?? null);
    this.letter.hidden = !many;
    setText(this.sign, light.sign);
    setText(this.law, law ?? "");
    setText(this.verdict, light.text);
    const state = status && status.state !== "connected" ? `${status.state} · ` : "";
    const robot = status?.robot ? `robot ${status.robot} · ` : "";
    const least = status?.least_passivity_mJ ?? null;
    setText(this.detail, (state + robot + (least === null ? "" : `least P ${digits(least)} mJ`)).replace(/ · $/, ""));
    this.help.hidden = least === null;
    setText(this.means, light.means(whose, `${digits(-least)} mJ`));
  }
}

export class Lights {
  constructor() {
    this.area = byId("lights");
    this.lights = [];
    this.laws = [];
    this.states = [];
  }

  /** @param {string} whose hand it is: "your" or "the" */
  setTracks(tracks, whose) {
    this.whose = whose;
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
    this.lights.forEach((light, track) => light.show(this.laws[track], this.states[track], this.lights.length > 1, this.whose));
  }
}
