// The newest ticks of all tracks, for the charts: rows by number of the tick, so that tracks share their time.
//
// Each column is twice as long as what it holds; when it is full its newer half moves to the front. What is drawn is
// then a view of one piece, without copying. Beside the ticks there are the least and the largest value
// of so many together, for windows in which single ticks are narrower than a pixel.

/** How many ticks are drawn together, from fine to coarse. */
const kTogether = [8, 32, 128];

/** Tracks do not come in the same message: the newest tick of one may be some older than that of the other. */
const kBack = 50;

/** Columns over one spacing of rows. */
class Table {
  constructor(columns, rows) {
    this.rows = rows;
    this.first = 0; // number of the row at index 0
    this.end = 0; // number of the row after the newest
    this.time_s = new Float64Array(2 * rows);
    this.columns = columns.map(() => new Float32Array(2 * rows).fill(NaN));
  }

  clear(next) {
    this.first = next;
    this.end = next;
  }

  /** Makes room up to row `number`; new rows hold nothing. */
  reach(number, row_s) {
    if (number < this.end) return;
    if (number - this.end >= this.rows) this.clear(number);
    if (number - this.first >= 2 * this.rows) {
      const from = number - this.rows - this.first;
      const to = this.end - this.first;
      this.time_s.copyWithin(0, from, to);
      for (const column of this.columns) column.copyWithin(0, from, to);
      this.first += from;
    }
    for (let row = this.end; row <= number; ++row) this.time_s[row - this.first] = row * row_s;
    for (const column of this.columns) column.fill(NaN, this.end - this.first, number + 1 - this.first);
    this.end = number + 1;
  }

  holds(number) {
    return number >= this.first && number >= this.end - this.rows && number < this.end;
  }

  /** Views from the first row at or after `from` to the last before `to`, into `out`: the times, then each column. */
  slice(columns, from, to, out) {
    const begin = Math.min(Math.max(from, this.first, this.end - this.rows), this.end) - this.first;
    const end = Math.max(Math.min(to, this.end) - this.first, begin);
    out[0] = this.time_s.subarray(begin, end);
    for (let i = 0; i < columns.length; ++i) out[i + 1] = this.columns[columns[i]].subarray(begin, end);
    return out;
  }
}

export class TickStore {
  /**
   * @param {string[]} columns names
   * @param {number} period_s of the tick
   * @param {number} span_s how much is kept
   */
  constructor(columns, period_s, span_s) {
    this.names = new Map(columns.map((name, index) => [name, index]));
    this.period_s = period_s;
    const rows = Math.ceil(span_s / period_s);
    this.ticks = new Table(columns, rows);
    this.tiers = kTogether.map((together) => ({ together, table: new Table(columns, 2 * Math.ceil(rows / together)) }));
    this.empty = true;
  }

  column(name) {
    return this.names.get(name);
  }

  /** Time of the newest tick [s]. */
  get newest_s() {
    return this.empty ? 0 : (this.ticks.end - 1) * this.period_s;
  }

  /** Time of the oldest tick that is held [s]. */
  get oldest_s() {
    const table = this.ticks;
    return this.empty ? 0 : Math.max(table.first, table.end - table.rows) * this.period_s;
  }

  clear() {
    this.empty = true;
  }

  /** @returns {number} the row for a tick at this time; what is far from all others begins the store anew */
  row(time_s) {
    const number = Math.round(time_s / this.period_s);
    const late = this.ticks.end - number;
    if (this.empty || late > 1 / this.period_s || -late > this.ticks.rows) {
      this.ticks.clear(number);
      for (const { together, table } of this.tiers) table.clear(2 * Math.floor(number / together));
      this.empty = false;
    }
    this.ticks.reach(number, this.period_s);
    for (const { together, table } of this.tiers) {
      table.reach(2 * Math.floor(number / together) + 1, (this.period_s * together) / 2);
    }
    return number;
  }

  set(number, column, value) {
    if (!Number.isFinite(value) || !this.ticks.holds(number)) return;
    this.ticks.columns[column][number - this.ticks.first] = value;
    for (const { together, table } of this.tiers) {
      const pair = 2 * Math.floor(number / together);
      if (!table.holds(pair)) continue;
      const values = table.columns[column];
      const least = pair - table.first;
      if (!(values[least] <= value)) values[least] = value;
      if (!(values[least + 1] >= value)) values[least + 1] = value;
    }
  }

  /** @returns {number} the value of the column at a time or at most `kBack` ticks before; NaN where there is none */
  at(column, time_s) {
    if (this.empty) return NaN;
    const number = Math.round(time_s / this.period_s);
    for (let row = number; row > number - kBack && this.ticks.holds(row); --row) {
      const value = this.ticks.columns[column][row - this.ticks.first];
      if (value === value) return value;
    }
    return NaN;
  }

  /** Views for a window, of at most `points` rows where the coarsest tier is enough for that. */
  window(columns, from_s, to_s, points, out) {
    let table = this.ticks;
    let row_s = this.period_s;
    for (const tier of this.tiers) {
      if ((to_s - from_s) / row_s <= points) break;
      table = tier.table;
      row_s = (this.period_s * tier.together) / 2;
    }
    return table.slice(columns, Math.floor(from_s / row_s), Math.ceil(to_s / row_s) + 1, out);
  }
}
