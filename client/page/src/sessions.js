// The server's page: who is connected, and how much the server has to do.
import { byId, make, setText } from "./dom.js";
import { digits, duration, whole } from "./text.js";

/** Heading and content of each column. */
const kColumns = [
  ["Client", (s) => s.client || ""],
  ["Address", (s) => s.address ?? "–"],
  ["Scene", (s) => s.scene ?? "–"],
  ["Device", (s) => s.device ?? "–"],
  ["State", (s) => s.state ?? "–"],
  ["Motions lost [%]", (s) => digits(s.lost_up_percent, 2), true],
  ["Computing [µs]", (s) => (s.compute_us ? `${digits(s.compute_us.median)}, 1 % above ${digits(s.compute_us.p99)}` : "–"), true],
  ["Faults", (s) => (s.faults ?? []).filter(({ count }) => count > 0).map(({ name, count }) => `${whole(count)} × ${name}`).join(", ") || "none"],
  ["Since", (s) => (Number.isFinite(s.since_s) ? duration(s.since_s) : "–"), true],
];

export class Sessions {
  /** @param {(message: object) => void} send */
  constructor(send) {
    this.send = send;
    this.rows = new Map(); // id -> {row, cells, kick}
    this.heads = kColumns.map(([name, , number]) => make("th", { scope: "col", className: number ? "number" : "" }, name));
    byId("session-head").append(...this.heads, make("th", { scope: "col" }, "End it"));
    this.body = byId("session-rows");
  }

  /** A column of which nobody has anything, such as names where there are no keys, is not shown. */
  #hideEmpty() {
    kColumns.forEach((_, i) => {
      const cells = [...this.rows.values()].map((row) => row.cells[i]);
      const empty = cells.every((cell) => cell.textContent === "");
      for (const cell of [this.heads[i], ...cells]) cell.hidden = empty;
    });
  }

  show({ sessions, load }, readOnly) {
    const seen = new Set(sessions.map(({ id }) => id));
    for (const [id, { row }] of this.rows) {
      if (seen.has(id)) continue;
      row.remove();
      this.rows.delete(id);
    }
    for (const session of sessions) {
      const { cells, kick } = this.rows.get(session.id) ?? this.#add(session);
      kColumns.forEach(([, text], i) => setText(cells[i], text(session)));
      kick.disabled = readOnly;
    }
    this.#hideEmpty();
    byId("no-sessions").hidden = sessions.length > 0;
    byId("session-table").hidden = sessions.length === 0;
    this.#showLoad(load);
  }

  #add(session) {
    const cells = kColumns.map(([name, , number]) => {
      const cell = make("td", { className: number ? "number" : "" });
      cell.dataset.label = name;
      return cell;
    });
    const kick = make("button", { type: "button", className: "kick", "aria-label": `End the session of ${session.client || session.address}` }, "Kick");
    // Asked twice: it ends what somebody else is doing.
    let armed = 0;
    kick.addEventListener("click", () => {
      if (!armed) {
        kick.textContent = "Sure?";
        armed = window.setTimeout(() => {
          armed = 0;
          kick.textContent = "Kick";
        }, 3000);
        return;
      }
      window.clearTimeout(armed);
      armed = 0;
      kick.textContent = "Kick";
      this.send({ kind: "kick", session: session.id });
    });
    const row = make("tr", {}, ...cells, make("td", {}, kick));
    row.dataset.session = String(session.id);
    this.body.append(row);
    const made = { row, cells, kick };
    this.rows.set(session.id, made);
    return made;
  }

  #showLoad(load) {
    if (!load) return;
    const percent = load.processor_percent;
    byId("load-processor").value = percent ?? 0;
    setText(byId("load-processor-text"), `${digits(percent)} %`);
    setText(byId("load-motions-text"), `${whole(load.motions_per_s)} per second`);
    byId("load-places").max = Math.max(load.places ?? 1, 1);
    byId("load-places").value = load.places_used ?? 0;
    setText(byId("load-places-text"), `${whole(load.places_used)} of ${whole(load.places)}`);
  }
}
