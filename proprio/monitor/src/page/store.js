// Rows in columns: the last ten minutes of a live arm, or a session.

/** Rows that are kept. */
export const ROOM = 60_000;

export class Store {
  /** @param {string[]} names of the columns; room for twice the rows, so that they are always in one piece. */
  constructor(names, room = ROOM) {
    this.names = names;
    this.room = room;
    this.times = new Float64Array(2 * room);
    this.columns = names.map(() => new Float32Array(2 * room));
    this.byName = new Map(names.map((name, i) => [name, this.columns[i]]));
    /** Columns that are computed from others. */
    this.derived = [];
    this.clear();
  }

  clear() {
    this.begin = 0;
    this.end = 0;
  }

  get count() { return this.end - this.begin; }
  get first() { return this.count ? this.times[this.begin] : NaN; }
  get last() { return this.count ? this.times[this.end - 1] : NaN; }

  column(name) { return this.byName.get(name); }

  /** Adds a column that is computed from others, unless it is there: `compute(row)` returns its value. */
  derive(name, compute) {
    if (this.byName.has(name)) return;
    const column = new Float32Array(2 * this.room);
    this.byName.set(name, column);
    this.derived.push({ column, compute });
    for (let row = this.begin; row < this.end; row++) column[row] = compute(row);
  }

  push(time, values) {
    if (this.end === this.times.length) {
      for (const array of [this.times, ...this.columns, ...this.derived.map(({ column }) => column)]) array.copyWithin(0, this.end - this.room, this.end);
      this.begin = 0;
      this.end = this.room;
    }
    this.times[this.end] = time;
    for (let i = 0; i < values.length; i++) this.columns[i][this.end] = values[i] ?? NaN;
    for (const { column, compute } of this.derived) column[this.end] = compute(this.end);
    this.end++;
    this.begin = Math.max(this.begin, this.end - this.room);
  }

  /** Row of the last time that is not after this one, or the first row. */
  rowAt(time) {
    let low = this.begin, high = this.end;
    while (low < high) {
      const middle = (low + high) >> 1;
      if (this.times[middle] <= time) low = middle + 1; else high = middle;
    }
    return Math.max(this.begin, low - 1);
  }

  /** Numbers of the columns of one kind, from 1. */
  numbers(prefix, suffix) {
    const found = [];
    while (this.column(`${prefix}${found.length + 1}${suffix}`)) found.push(found.length + 1);
    return found;
  }

  /** Columns of one kind, a segment each: `series('theta', '_deg')`. */
  series(prefix, suffix) { return this.numbers(prefix, suffix).map((i) => this.column(`${prefix}${i}${suffix}`)); }

  /** Time of the first row with a value in one of these columns; of the first row where there is none. */
  firstValue(columns) {
    for (let row = this.begin; row < this.end; row++) {
      if (columns.some((column) => Number.isFinite(column[row]))) return this.times[row];
    }
    return this.first;
  }

  /** Replaces its rows by those of the server's answer; returns the description in front of them. */
  load(buffer) {
    const head = headOf(buffer);
    const { about, offset } = head;
    // The arm may have changed since the request.
    if (about.columns !== this.columns.length) return about;
    this.clear();
    this.times.set(new Float64Array(buffer, offset, about.rows));
    const floats = new Float32Array(buffer, offset + 8 * about.rows);
    this.columns.forEach((column, i) => column.set(floats.subarray(i * about.rows, (i + 1) * about.rows)));
    this.end = about.rows;
    for (const { column, compute } of this.derived) {
      for (let row = 0; row < this.end; row++) column[row] = compute(row);
    }
    return about;
  }
}

/** Header of an answer: one line of JSON, before the numbers. */
export function headOf(buffer) {
  const bytes = new Uint8Array(buffer);
  const end = bytes.indexOf(10);
  return { about: JSON.parse(new TextDecoder().decode(bytes.subarray(0, end))), offset: end + 1 };
}
