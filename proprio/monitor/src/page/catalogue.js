// Kinds of plots, and the curves of each, from the columns of the rows.

import { ellipse } from './arm.js';

/** Voltage of one count of the board's converter, V. */
const VOLT = 3.3 / 4095;

/**
 * Kinds of plots, in the order of the menu: `least` is the smallest range of values, `digits` those behind the point. A curve has
 * a name, the name of its column, and the number of its colour; the `segment` that shows and hides it, if it is of one; and
 * `isSecond` where another curve has the same colour, and `isOptional` where its values are shown only if there are any.
 */
export const KINDS = [
  { id: 'theta', title: 'Bend angle θ', unit: '°', least: 20, digits: 2, curves: segments('theta', '_deg') },
  { id: 'drift', title: 'Drift taken from the IMUs', unit: '°', least: 2, digits: 2, needs: 'replica', curves: segments('drift', '_deg') },
  { id: 'innovation_imu', title: 'Innovation by the corrected IMUs', unit: '°', least: 1, digits: 2, needs: 'replica', curves: segments('innovation_imu', '_deg') },
  { id: 'innovation_bend', title: 'Innovation by the bend sensors', unit: '°', least: 4, digits: 2, needs: 'replica', curves: segments('innovation_bend', '_deg') },
  { id: 'counts', title: 'Bend sensors', unit: 'counts', least: 100, digits: 0, curves: (store) => sensors(store, (name) => name) },
  { id: 'volts', title: 'Bend sensors', unit: 'V', least: 0.1, digits: 3, curves: (store) => sensors(store, (name) => volts(store, name)) },
  { id: 'imu', title: 'Heading by the IMUs, as read', unit: '°', least: 20, digits: 1, curves: segments('imu', '_deg') },
  { id: 'heading', title: 'Heading of the segments\' ends, estimated', unit: '°', least: 20, digits: 1, curves: headings },
  { id: 'tip', title: 'Tip x and y', unit: 'mm', least: 50, digits: 1, curves: tip },
  { id: 'tip_error', title: 'Tip error and 95 % ellipse', unit: 'mm', least: 10, digits: 1, needs: 'truth', curves: tipError },
  { id: 'pressure', title: 'Pressures, requested and set', unit: 'kPa', least: 20, digits: 1, needs: 'pressures', curves: pressures },
  { id: 'contact', title: 'Contact score, contact from 100', unit: '%', least: 120, digits: 0, needs: 'contact', curves: segments('contact', '_percent') },
  { id: 'deviation', title: 'Standard deviation of θ', unit: '°', least: 0.5, digits: 3, needs: 'uncertainty', curves: segments('theta', '_deviation_deg') },
];

/** The plots of a browser that has chosen none. */
export const USUAL = ['theta', 'drift', 'innovation_imu', 'innovation_bend'];

/** Reasons why a plot has no values. */
export function reason(needs, { store, isSession, hasTable }) {
  if (!store?.count) return 'nothing has come yet';
  if (needs === 'truth') return isSession ? 'no truth in this session' : 'truth is in sessions alone';
  if (needs === 'pressures') return isSession ? 'no pressures in this session' : 'no pressures have come yet';
  if (needs && !hasTable) return 'takes a table: --table TABLE.toml, or one on the board';
  if (needs === 'contact') return 'the table has no limits of contact';
  if (needs === 'uncertainty') return 'the table has no error sources';
  return needs && !isSession ? 'known from the next tare on' : 'not known here';
}

/** A curve for each segment. */
function segments(prefix, suffix) {
  return (store) => store.numbers(prefix, suffix).map((i) => ({ name: `segment ${i}`, short: `${i}`, column: `${prefix}${i}${suffix}`, colour: i - 1, segment: i - 1 }));
}

function sensors(store, column) {
  return store.names.flatMap((name) => {
    const [, i, sensor] = name.match(/^bend(\d+)([ab])_adc$/) ?? [];
    if (!i) return [];
    return [{ name: `bend ${i}${sensor}`, short: i + sensor, column: column(name), colour: i - 1, segment: i - 1, isSecond: sensor === 'b' }];
  });
}

function volts(store, counts) {
  const column = store.column(counts), name = counts.replace('_adc', '_v');
  store.derive(name, (row) => column[row] * VOLT);
  return name;
}

function headings(store) {
  const thetas = store.series('theta', '_deg');
  return thetas.map((_, i) => {
    const name = `heading${i + 1}_deg`;
    store.derive(name, (row) => thetas.slice(0, i + 1).reduce((sum, theta) => sum + theta[row], 0));
    return { name: `segment ${i + 1}`, short: `${i + 1}`, column: name, colour: i, segment: i };
  });
}

function tip(store) {
  const n = store.series('x', '_mm').length;
  if (!n) return [];
  return [
    { name: 'tip x', short: 'x', column: `x${n}_mm`, colour: 0 }, { name: 'tip y', short: 'y', column: `y${n}_mm`, colour: 1 },
    { name: 'true x', short: 'true x', column: `truth${n}_x_mm`, colour: 0, isSecond: true, isOptional: true }, { name: 'true y', short: 'true y', column: `truth${n}_y_mm`, colour: 1, isSecond: true, isOptional: true },
  ];
}

function tipError(store) {
  const n = store.series('x', '_mm').length;
  if (!n) return [];
  const [x, y, trueX, trueY] = [`x${n}_mm`, `y${n}_mm`, `truth${n}_x_mm`, `truth${n}_y_mm`].map((name) => store.column(name));
  store.derive('tip_error_mm', (row) => Math.hypot(x[row] - trueX[row], y[row] - trueY[row]));
  const covariance = ['xx', 'xy', 'yy'].map((part) => store.column(`end${n}_${part}_mm2`));
  const axes = (row) => ellipse(covariance.map((part) => part[row]));
  store.derive('tip_major_mm', (row) => axes(row).major);
  store.derive('tip_minor_mm', (row) => axes(row).minor);
  return [
    { name: 'tip error', short: 'error', column: 'tip_error_mm', colour: 0, isOptional: true },
    { name: 'longer semi-axis', short: 'longer semi-axis', column: 'tip_major_mm', colour: 1 },
    { name: 'shorter semi-axis', short: 'shorter semi-axis', column: 'tip_minor_mm', colour: 2 },
  ];
}

function pressures(store) {
  return store.numbers('pressure', '_set_kpa').flatMap((i) => {
    const module = `${(i + 1) >> 1} ${i % 2 ? 'right' : 'left'}`;
    return [['set', ''], ['requested', 'requested ']].map(([what, before]) => ({
      name: `${before}module ${module}`, short: `${before}${module}`, column: `pressure${i}_${what}_kpa`, colour: i - 1, isSecond: what === 'requested', isOptional: what === 'requested',
    }));
  });
}
