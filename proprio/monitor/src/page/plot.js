// Plots over time, of any number of rows.

/** Opacity of the second curve of a colour. */
export const SECOND = 0.45;

const LEFT = 48, RIGHT = 10, TOP = 8, BOTTOM = 20;

/** One plot's range of values. */
export class Range {
  constructor(least) {
    this.least = least;
    this.reset();
  }

  reset() { [this.low, this.high] = [-this.least / 2, this.least / 2]; }

  /** Follows the visible values: grows at once, and shrinks where much of the range is empty, so that it does not flicker. */
  follow(low, high) {
    if (!(low <= high)) return;
    const pad = Math.max(0.06 * (high - low), (this.least - (high - low)) / 2, 0);
    const [wantLow, wantHigh] = [low - pad, high + pad];
    if (low < this.low || high > this.high || wantHigh - wantLow < 0.6 * (this.high - this.low)) {
      [this.low, this.high] = [wantLow, wantHigh];
    }
  }

  /** Makes the range smaller by a factor, around a share of its height. */
  zoom(factor, share = 0.5) {
    const at = this.low + share * (this.high - this.low), height = (this.high - this.low) * factor;
    [this.low, this.high] = [at - share * height, at + (1 - share) * height];
  }

  move(share) {
    const by = share * (this.high - this.low);
    this.low += by;
    this.high += by;
  }
}

/** Rows between two times, and one on each side, so that lines reach the edge; none after the limit. */
export function visible(store, from, to, limit) {
  return [store.rowAt(from), Math.min(store.end, store.rowAt(to) + 2, store.rowAt(limit) + 1)];
}

/** Least and largest of the columns in these rows. */
export function extent(columns, first, last) {
  let low = Infinity, high = -Infinity;
  for (const column of columns) {
    for (let i = first; i < last; i++) {
      const value = column[i];
      if (value < low) low = value;
      if (value > high) high = value;
    }
  }
  return [low, high];
}

/**
 * Points of one line: all of them, or of each pixel's column the first, least, largest and last, so that no spike is lost.
 * A gap, NaN or half a second without a row, ends a piece.
 */
export function pieces(times, column, first, last, toX, toY) {
  const found = [];
  let piece = null, pixel = NaN, low = 0, high = 0, end = 0, before = NaN;
  const close = () => {
    if (!piece) return;
    if (low !== high) piece.push(pixel, toY(low), pixel, toY(high));
    piece.push(pixel, toY(end));
  };
  for (let i = first; i < last; i++) {
    const value = column[i], time = times[i];
    if (Number.isNaN(value) || time - before > 0.5 + 3 * gap(times, i, first)) {
      close();
      piece = null;
    }
    before = time;
    if (Number.isNaN(value)) continue;
    const x = Math.round(toX(time));
    if (!piece) {
      piece = [x, toY(value)];
      found.push(piece);
    } else if (x !== pixel) {
      close();
      piece.push(x, toY(value));
    } else {
      if (value < low) low = value;
      if (value > high) high = value;
      end = value;
      continue;
    }
    [pixel, low, high, end] = [x, value, value, value];
  }
  close();
  return found;
}

/** Time between rows at the start of the visible part: a slow session is no gap. */
function gap(times, i, first) {
  return i > first + 1 ? times[first + 1] - times[first] : 0;
}

/** About this number of steps of 1, 2 or 5 times a power of ten. */
export function ticks(low, high, about) {
  const rough = (high - low) / about, power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].map((times) => times * power).find((candidate) => candidate >= rough);
  const found = [];
  for (let i = Math.ceil(low / step); i * step <= high + 1e-9 * step; i++) found.push(i * step);
  return { step, found };
}

/** Steps of ticks of time from a second on, s. */
const SECONDS = [1, 2, 5, 10, 15, 30, 60, 120, 300, 600, 900, 1800, 3600];

/** Ticks of time, at most about this number. */
export function timeTicks(from, to, about) {
  const rough = (to - from) / about - 1e-9;
  if (rough <= 0.5) return ticks(from, to, about);
  const step = SECONDS.find((candidate) => candidate >= rough) ?? Math.ceil(rough / 3600) * 3600;
  const found = [];
  for (let i = Math.ceil(from / step); i * step <= to; i++) found.push(i * step);
  return { step, found };
}

const shown = (value, step) => minus(value.toFixed(Math.max(0, -Math.floor(Math.log10(step) + 1e-9))));

/** With a minus instead of a hyphen, and no minus in front of nothing. */
export const minus = (digits) => (/^-[0.]*$/.test(digits) ? digits.slice(1) : digits.replace('-', '−'));

/** Minutes and seconds where there are minutes. */
export function clock(seconds, step = 0.01) {
  const digits = Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
  if (Math.abs(seconds) < 60) return `${seconds.toFixed(digits)} s`;
  const minutes = Math.floor(seconds / 60), rest = (seconds - 60 * minutes).toFixed(digits);
  return `${minutes}:${rest.padStart(digits ? digits + 3 : 2, '0')}`;
}

/** Draws one plot onto a canvas or an SVG of this size. */
export function drawPlot(c, width, height, spec) {
  const { store, curves, range, from, to, limit, cursor, marks, colours, empty } = spec;
  const inner = { x: LEFT, y: TOP, w: width - LEFT - RIGHT, h: height - TOP - BOTTOM };
  const toX = (time) => inner.x + ((time - from) / (to - from)) * inner.w;
  const toY = (value) => inner.y + (1 - (value - range.low) / (range.high - range.low)) * inner.h;
  axes(c, inner, { from, to, range, toX, toY, colours, width });
  if (empty) {
    c.fillStyle = colours.faint;
    c.textAlign = 'center';
    c.textBaseline = 'middle';
    c.fillText(empty, inner.x + inner.w / 2, inner.y + 0.4 * inner.h);
    return;
  }
  c.save();
  c.beginPath();
  c.rect(inner.x, inner.y, inner.w, inner.h);
  c.clip();
  for (const { time_s, text } of marks) {
    vertical(c, toX(time_s), inner, colours.faint, [2, 3]);
    Object.assign(c, { fillStyle: colours.faint, textAlign: 'left', textBaseline: 'top' });
    c.fillText(text, toX(time_s) + 3, inner.y + 2);
  }
  if (store?.count) {
    // Where rows are dense, lines of one pixel: browsers draw them twenty times as fast as wider ones.
    c.lineJoin = 'bevel';
    for (const { store: own, column, colour, isSecond, isOverlay } of curves) {
      const [first, last] = visible(own, from, to, limit);
      c.lineWidth = last - first > inner.w ? 1 : 1.6;
      c.setLineDash(isOverlay ? [6, 4] : []);
      c.strokeStyle = colours.series[colour % colours.series.length];
      c.globalAlpha = isSecond ? SECOND : 1;
      c.beginPath();
      for (const piece of pieces(own.times, column, first, last, toX, toY)) {
        c.moveTo(piece[0], piece[1]);
        if (piece.length === 4 && piece[0] === piece[2]) c.lineTo(piece[0] + 1, piece[1]);
        for (let k = 2; k < piece.length; k += 2) c.lineTo(piece[k], piece[k + 1]);
      }
      c.stroke();
    }
    c.globalAlpha = 1;
    c.setLineDash([]);
  }
  if (Number.isFinite(cursor)) vertical(c, toX(cursor), inner, colours.ink, []);
  c.restore();
}

function vertical(c, x, inner, colour, dash) {
  c.strokeStyle = colour;
  c.lineWidth = 1;
  c.setLineDash(dash);
  c.beginPath();
  c.moveTo(x, inner.y);
  c.lineTo(x, inner.y + inner.h);
  c.stroke();
  c.setLineDash([]);
}

function axes(c, inner, { from, to, range, toX, toY, colours, width }) {
  c.font = `11px ${colours.font}`;
  c.lineWidth = 1;
  c.textBaseline = 'middle';
  c.textAlign = 'right';
  const vertical = ticks(range.low, range.high, 6);
  for (const value of vertical.found) {
    const y = Math.round(toY(value)) + 0.5;
    c.strokeStyle = colours.grid;
    c.beginPath();
    c.moveTo(inner.x, y);
    c.lineTo(inner.x + inner.w, y);
    c.stroke();
    c.fillStyle = colours.faint;
    c.fillText(shown(value, vertical.step), inner.x - 6, y);
  }
  c.textBaseline = 'top';
  const horizontal = timeTicks(from, to, Math.max(2, width / 110));
  // There is nothing before the begin.
  for (const time of horizontal.found.filter((found) => found >= 0)) {
    const x = Math.round(toX(time)) + 0.5;
    c.strokeStyle = colours.grid;
    c.beginPath();
    c.moveTo(x, inner.y);
    c.lineTo(x, inner.y + inner.h);
    c.stroke();
    c.fillStyle = colours.faint;
    // Text stays inside at both ends.
    c.textAlign = x < inner.x + 16 ? 'left' : x > inner.x + inner.w - 16 ? 'right' : 'center';
    c.fillText(clock(time, horizontal.step), x, inner.y + inner.h + 5);
  }
}

/** Position of a pointer in a plot, as shares of its width and height. */
export function shares(canvas, event) {
  const box = canvas.getBoundingClientRect();
  const x = (event.clientX - box.left - LEFT) / (box.width - LEFT - RIGHT);
  const y = 1 - (event.clientY - box.top - TOP) / (box.height - TOP - BOTTOM);
  return [Math.min(1, Math.max(0, x)), Math.min(1, Math.max(0, y))];
}

/** Distance of a share of the width from the left of the canvas, pixels. */
export const offset = (canvas, share) => LEFT + share * innerWidth(canvas);

/** Width of a plot's inside. */
export const innerWidth = (canvas) => canvas.clientWidth - LEFT - RIGHT;

/** The canvas as large as it is seen, and its size in CSS pixels. */
export function fit(canvas) {
  const { clientWidth: width, clientHeight: height } = canvas;
  const ratio = devicePixelRatio;
  const [w, h] = [Math.round(width * ratio), Math.round(height * ratio)];
  if (canvas.width !== w || canvas.height !== h) Object.assign(canvas, { width: w, height: h });
  const c = canvas.getContext('2d');
  c.setTransform(ratio, 0, 0, ratio, 0, 0);
  c.clearRect(0, 0, width, height);
  return [c, width, height];
}
