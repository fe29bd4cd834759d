// The arm, to scale.

import { minus } from './plot.js';

const RAD = Math.PI / 180;
/** Time of the tip's trail, s. */
const TRAIL = 10;
/** Length of a segment whose table is not known, mm. */
const LENGTH = 100;

/** Segments of the arm in one row: ends, headings, and the line between them, mm. */
export function shape(store, row, geometry) {
  const thetas = store.series('theta', '_deg'), xs = store.series('x', '_mm'), ys = store.series('y', '_mm');
  const segments = [];
  let x = 0, y = 0, heading = 0;
  for (let i = 0; i < thetas.length; i++) {
    const theta = thetas[i][row] * RAD, end = [xs[i][row], ys[i][row]];
    if (![theta, ...end].every(Number.isFinite)) break;
    segments.push({ line: line(x, y, heading, theta, end, geometry?.[i]), end, heading: heading + theta });
    [x, y] = end;
    heading += theta;
  }
  return segments;
}

/** Points from a segment's start to its end: connector and arc, with the difference of the two filters spread over them. */
function line(x, y, heading, theta, end, geometry) {
  const chord = Math.hypot(end[0] - x, end[1] - y);
  const half = theta / 2;
  const length = geometry?.length_mm ?? chord * (Math.abs(half) < 1e-6 ? 1 : half / Math.sin(half));
  const offset = geometry?.offset_mm ?? 0;
  const points = [[x, y]];
  const go = (distance, direction) => {
    const [px, py] = points.at(-1);
    points.push([px + distance * Math.sin(direction), py + distance * Math.cos(direction)]);
  };
  if (offset && !geometry.offset_at_end) go(offset, heading);
  const steps = 12, arc = Math.abs(half / steps) < 1e-6 ? 1 : Math.sin(half / steps) / (half / steps);
  for (let i = 0; i < steps; i++) go((length / steps) * arc, heading + (theta * (i + 0.5)) / steps);
  if (offset && geometry.offset_at_end) go(offset, heading + theta);
  const [dx, dy] = [end[0] - points.at(-1)[0], end[1] - points.at(-1)[1]];
  return points.map(([px, py], i) => {
    const share = i / (points.length - 1);
    return [px + dx * share, py + dy * share];
  });
}

/** Semi-axis of a 95 % ellipse in standard deviations: the root of χ² with two degrees of freedom. */
const SIGMAS = Math.sqrt(5.991);

/** Semi-axes, mm, and angle of the longer one from x to y, rad, of the 95 % ellipse of a covariance xx, xy, yy in mm². */
export function ellipse([xx, xy, yy]) {
  const mean = (xx + yy) / 2, spread = Math.hypot((xx - yy) / 2, xy);
  const axis = (variance) => SIGMAS * Math.sqrt(Math.max(0, variance));
  return { major: axis(mean + spread), minor: axis(mean - spread), turn: Math.atan2(2 * xy, xx - yy) / 2 };
}

/** Covariance xx, xy, yy of each segment's end in one row, mm²; NaN where it is not known. */
export function covariances(store, row) {
  const parts = ['_xx_mm2', '_xy_mm2', '_yy_mm2'].map((suffix) => store.series('end', suffix));
  return parts[0].map((_, i) => parts.map((part) => part[i][row]));
}

/** Contact of each segment in one row. */
export const contacts = (store, row) => store.series('in_contact', '').map((column) => column[row] === 1);

/** Draws the arm in one row onto a canvas or an SVG of this size. */
export function drawArm(c, width, height, { store, row, geometry, colours, overlay }) {
  const length = geometry?.reduce((sum, { length_mm, offset_mm }) => sum + length_mm + offset_mm, 0) ?? LENGTH * Math.max(1, store?.series('theta', '_deg').length ?? 0);
  const scale = Math.min(width / (2.1 * length), height / (1.6 * length));
  const to = ([x, y]) => [width / 2 + x * scale, height - 0.42 * length * scale - y * scale];
  grid(c, width, height, to, scale, colours);
  if (!store?.count) return;

  c.lineCap = 'round';
  c.lineJoin = 'round';
  trail(c, store, row, to, colours);
  const segments = shape(store, row, geometry), covariance = covariances(store, row), contact = contacts(store, row);
  const thick = Math.max(5, 26 * scale);
  segments.forEach(({ line }, i) => {
    if (contact[i]) path(c, line.map(to), { colour: colours.bad, width: thick + 8 });
    path(c, line.map(to), { colour: colours.series[i % colours.series.length], width: thick });
  });
  segments.forEach(({ end, heading }, i) => {
    joint(c, to(end), heading, thick, colours);
    if (!covariance[i]?.every(Number.isFinite)) return;
    const { major, minor, turn } = ellipse(covariance[i]);
    c.beginPath();
    c.ellipse(...to(end), major * scale, minor * scale, -turn, 0, 2 * Math.PI);
    c.strokeStyle = colours.ink;
    c.lineWidth = 1.5;
    c.stroke();
  });
  truth(c, store, row, to, colours);
  if (overlay) drawOverlay(c, to, scale, overlay, colours);
}

/** Draws the arm of another session as a dashed line through its middle, with its ends. */
function drawOverlay(c, to, scale, { store, row, geometry }, colours) {
  const width = Math.max(2.5, 8 * scale);
  for (const { line, end } of shape(store, row, geometry)) {
    path(c, line.map(to), { colour: colours.ink, width, alpha: 0.75, dash: [8, 8] });
    const [x, y] = to(end);
    c.beginPath();
    c.ellipse(x, y, width / 2, width / 2, 0, 0, 2 * Math.PI);
    c.strokeStyle = colours.ink;
    c.lineWidth = width;
    c.stroke();
  }
}

function path(c, points, { colour, width, alpha = 1, dash = [] }) {
  c.globalAlpha = alpha;
  c.strokeStyle = colour;
  c.lineWidth = width;
  c.setLineDash(dash);
  c.beginPath();
  points.forEach(([x, y], i) => (i ? c.lineTo(x, y) : c.moveTo(x, y)));
  c.stroke();
  c.setLineDash([]);
  c.globalAlpha = 1;
}

/** Lines every 100 mm, the base, and a scale of 100 mm. */
function grid(c, width, height, to, scale, colours) {
  const [x0, y0] = to([0, 0]);
  const step = 100 * scale;
  for (let x = x0 % step; x < width; x += step) path(c, [[x, 0], [x, height]], { colour: colours.grid, width: 1 });
  for (let y = y0 % step; y < height; y += step) path(c, [[0, y], [width, y]], { colour: colours.grid, width: 1 });
  path(c, [[x0 - 28 * scale, y0], [x0 + 28 * scale, y0]], { colour: colours.ink, width: Math.max(3, 10 * scale) });
  path(c, [[12, height - 14], [12 + step, height - 14]], { colour: colours.ink, width: 2 });
  c.fillStyle = colours.ink;
  c.font = `12px ${colours.font}`;
  c.textAlign = 'left';
  c.textBaseline = 'alphabetic';
  c.fillText('100 mm', 12, height - 20);
}

function joint(c, [x, y], heading, thick, colours) {
  const [dx, dy] = [Math.cos(heading) * thick * 0.5, Math.sin(heading) * thick * 0.5];
  path(c, [[x - dx, y - dy], [x + dx, y + dy]], { colour: colours.paper, width: 2.5 });
}

function trail(c, store, row, to, colours) {
  const x = store.series('x', '_mm').at(-1), y = store.series('y', '_mm').at(-1);
  const from = store.rowAt(store.times[row] - TRAIL);
  const every = Math.max(1, Math.floor((row - from) / 250));
  let points = [];
  for (let i = from; i <= row; i += every) {
    if (Number.isFinite(x[i])) points.push(to([x[i], y[i]]));
  }
  path(c, points, { colour: colours.trail, width: 2, alpha: 0.8 });
}

function truth(c, store, row, to, colours) {
  const x = store.series('truth', '_x_mm'), y = store.series('truth', '_y_mm');
  const ends = x.map((column, i) => [column[row], y[i][row]]).filter(([a]) => Number.isFinite(a)).map(to);
  if (!ends.length) return;
  if (ends.length === x.length) path(c, [to([0, 0]), ...ends], { colour: colours.ink, width: 1.5, dash: [5, 5] });
  for (const [px, py] of ends) {
    c.beginPath();
    c.ellipse(px, py, 5, 5, 0, 0, 2 * Math.PI);
    c.strokeStyle = colours.ink;
    c.lineWidth = 1.5;
    c.stroke();
  }
}

/** The values next to the arm. */
export function armValues(store, row) {
  const value = (name) => store.column(name)?.[row];
  const thetas = store.series('theta', '_deg').map((column) => column[row]);
  const n = thetas.length;
  const [x, y] = [value(`x${n}_mm`), value(`y${n}_mm`)];
  if (!Number.isFinite(x)) {
    const unknown = thetas.findIndex((theta) => !Number.isFinite(theta));
    return thetas.some(Number.isFinite) && unknown >= 0 ? `tip not known: no sensor tells the angle of segment ${unknown + 1}` : 'no estimate yet';
  }
  const heading = thetas.reduce((sum, theta) => sum + theta, 0);
  const [shownX, shownY, shownHeading] = [x, y, heading].map((number) => minus(number.toFixed(1)));
  const { major } = ellipse(covariances(store, row)[n - 1] ?? [NaN, NaN, NaN]);
  const within = Number.isFinite(major) ? `, ±${major.toFixed(1)} mm (95 %)` : '';
  const text = `tip x ${shownX} mm, y ${shownY} mm${within}, heading ${shownHeading}°`;
  const error = Math.hypot(x - value(`truth${n}_x_mm`), y - value(`truth${n}_y_mm`));
  return Number.isFinite(error) ? `${text}, ${error.toFixed(1)} mm from truth` : text;
}
