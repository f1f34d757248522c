// Numbers as people read them: three significant digits, with the unit.

/** @returns {string} the number with `digits` significant digits and no exponent; "–" for what is not known */
export function digits(value, count = 3) {
  if (value === null || value === undefined || !Number.isFinite(value)) return "–";
  if (value === 0) return "0";
  if (Math.abs(value) >= 1000) return Number(value.toPrecision(count + 1)).toLocaleString("en").replace(/^-/, "−");
  const before = Math.floor(Math.log10(Math.abs(value))) + 1;
  if (before < -4) return "0";
  const text = value.toFixed(Math.min(Math.max(count - before, 0), 4));
  return Number(text) === 0 ? "0" : text.replace(/^-/, "−");
}

/** @returns {string} a count with thousands apart: 12,345 */
export function whole(value) {
  return value === null || value === undefined ? "–" : Math.round(value).toLocaleString("en");
}

/** @returns {string} how long: "8 s", "3 min 5 s", "2 h 4 min" */
export function duration(seconds) {
  const s = Math.max(0, Math.floor(seconds));
  if (s < 60) return `${s} s`;
  if (s < 3600) return `${Math.floor(s / 60)} min ${s % 60} s`;
  return `${Math.floor(s / 3600)} h ${Math.floor((s % 3600) / 60)} min`;
}

/** @returns {string} a time of a run: "12.3 s", "3:05.2" with minutes */
export function runTime(seconds) {
  const tenths = Math.round(10 * seconds);
  if (tenths < 600) return `${(tenths / 10).toFixed(1)} s`;
  return `${Math.floor(tenths / 600)}:${((tenths % 600) / 10).toFixed(1).padStart(4, "0")}`;
}
