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

  push(time, values) {
    if (this.end === this.times.length) {
      for (const array of [this.times, ...this.columns]) array.copyWithin(0, this.end - this.room, this.end);
      this.begin = 0;
      this.end = this.room;
    }
    this.times[this.end] = time;
    for (let i = 0; i < values.length; i++) this.columns[i][this.end] = values[i] ?? NaN;
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

  /** Values of one kind, a segment each, in a row: `series('theta', '_deg')`. */
  series(prefix, suffix) {
    const found = [];
    for (let i = 1; ; i++) {
      const column = this.column(`${prefix}${i}${suffix}`);
      if (!column) return found;
      found.push(column);
    }
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
    return about;
  }
}

/** Header of an answer: one line of JSON, before the numbers. */
export function headOf(buffer) {
  const bytes = new Uint8Array(buffer);
  const end = bytes.indexOf(10);
  return { about: JSON.parse(new TextDecoder().decode(bytes.subarray(0, end))), offset: end + 1 };
}
