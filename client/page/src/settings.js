// What may be chosen: laws, scene, device, stiffness, the network between.
import { byId, make, setText } from "./dom.js";

const kSelects = [
  { id: "law", setting: "law", names: (hello) => hello.choices.laws },
  { id: "law-beside", setting: "law_beside", names: (hello) => hello.choices.laws, none: "no second law" },
  { id: "scene-name", setting: "scene", names: (hello) => hello.choices.scenes.map((name) => ({ name })), none: "the server's default" },
  { id: "device", setting: "device", names: (hello) => hello.choices.devices.map((name) => ({ name })) },
];

const kNetwork = ["delay_ms", "jitter_ms", "loss_percent"];

const kPresets = [
  { label: "Same room", value: { delay_ms: 0, jitter_ms: 0, loss_percent: 0 } },
  { label: "50 ms", value: { delay_ms: 50, jitter_ms: 0, loss_percent: 0 } },
  { label: "50 ± 10 ms, 5 %", value: { delay_ms: 50, jitter_ms: 10, loss_percent: 5 } },
];

// After the last move of a slider; so that a drag is one change, and one mark in the recording.
const kSettled_ms = 250;

export class Settings {
  /** @param {(message: object) => void} send */
  constructor(send) {
    this.send = send;
    this.hello = null;
    for (const { id, setting } of kSelects) {
      const select = byId(id);
      select.addEventListener("change", () => {
        this.send({ kind: "choose", setting, value: select.value === "" ? null : select.value });
        this.#describe();
      });
    }
    byId("stiffness").addEventListener("change", (event) => {
      const value = event.target.valueAsNumber;
      if (Number.isFinite(value)) this.send({ kind: "choose", setting: "stiffness_N_per_m", value });
    });
    this.#listenToNetwork();
    byId("settings-form").addEventListener("submit", (event) => event.preventDefault());
  }

  #listenToNetwork() {
    for (const name of kNetwork) {
      byId(name).addEventListener("input", () => {
        this.#showNetwork();
        window.clearTimeout(this.settling);
        this.settling = window.setTimeout(() => this.#sendNetwork(), kSettled_ms);
      });
      // Let go: at once.
      byId(name).addEventListener("change", () => this.#sendNetwork());
    }
    for (const { label, value } of kPresets) {
      const button = make("button", { type: "button" }, label);
      button.addEventListener("click", () => {
        for (const name of kNetwork) byId(name).value = String(value[name]);
        this.#showNetwork();
        this.settling = window.setTimeout(() => this.#sendNetwork(), 0);
      });
      byId("presets").append(button);
    }
  }

  #sendNetwork() {
    if (!this.settling) return;
    window.clearTimeout(this.settling);
    this.settling = 0;
    const value = Object.fromEntries(kNetwork.map((name) => [name, byId(name).valueAsNumber]));
    this.send({ kind: "choose", setting: "network", value });
  }

  #showNetwork() {
    for (const name of kNetwork) {
      const unit = name === "loss_percent" ? "%" : "ms";
      setText(byId(`${name}-value`), `${byId(name).value} ${unit}`);
    }
  }

  /** Shows what the program says is set; also puts back what it refused. */
  show(hello) {
    this.hello = hello;
    const fixed = hello.read_only || !hello.may_change;
    byId("settings-fields").disabled = fixed;
    byId("read-only").hidden = !fixed;
    for (const { id, setting, names, none } of kSelects) {
      const known = names(hello);
      byId(id).closest(".field").hidden = known.length === 0 && !hello.settings[setting];
      this.#fill(byId(id), known, hello.settings[setting], none);
    }
    const { stiffness_N_per_m: stiffness, network } = hello.settings;
    byId("stiffness").closest(".field").hidden = stiffness === null || stiffness === undefined;
    if (stiffness && document.activeElement !== byId("stiffness")) byId("stiffness").value = String(stiffness);
    byId("network-fields").hidden = !network;
    byId("no-relay").hidden = Boolean(network) || fixed;
    if (network && !this.settling) {
      for (const name of kNetwork) {
        // A program's value beyond the slider's end moves that end.
        if (network[name] > Number(byId(name).max)) byId(name).max = String(network[name]);
        byId(name).value = String(network[name]);
      }
      this.#showNetwork();
    }
    this.#describe();
  }

  #fill(select, known, chosen, none) {
    const names = known.map(({ name }) => name);
    if (chosen && !names.includes(chosen)) names.unshift(chosen);
    const texts = none ? [none, ...names] : names;
    const now = [...select.options].map((option) => option.text);
    if (now.join("\n") !== texts.join("\n")) {
      select.replaceChildren(...texts.map((text, i) => make("option", { value: none && i === 0 ? "" : text }, text)));
    }
    select.value = chosen ?? "";
  }

  #describe() {
    const law = this.hello?.choices.laws.find(({ name }) => name === byId("law").value);
    setText(byId("law-about"), law?.about ?? "");
  }
}
