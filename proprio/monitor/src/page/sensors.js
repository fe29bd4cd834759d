// List of the sensors: value, state, reason.

import { minus } from './plot.js';

/** Look of each state; any other state is bad. */
const LOOKS = { Ok: 'ok', Slow: 'warn', Intermittent: 'warn', read: 'ok', missing: 'bad', '–': 'none' };

export class SensorList {
  constructor(list) {
    this.list = list;
    this.sensors = [];
  }

  /** Adds an item for each bend sensor, then one for each IMU. */
  build(names) {
    const columns = names.filter((name) => /^(bend\d+[ab]_adc|imu\d+_deg)$/.test(name));
    this.list.replaceChildren();
    this.sensors = columns.map((column) => {
      const [, kind, number] = column.match(/^(bend|imu)(\d+[ab]?)/);
      const item = document.createElement('li');
      const part = (tag, className) => item.appendChild(Object.assign(document.createElement(tag), { className }));
      part('b', 'name').textContent = `${kind === 'imu' ? 'IMU' : 'bend'} ${number}`;
      const sensor = { column, kind, short: `${kind}${kind === 'imu' ? '' : ' '}${number}`, item, value: part('span', 'value'), state: part('span', 'state'), reason: part('span', 'reason') };
      item.id = `strip-${kind}${number}`;
      this.list.append(item);
      return sensor;
    });
  }

  /** Short name and state of each sensor. */
  states(health) { return this.sensors.map(({ short: name }, i) => ({ name, state: health?.[i]?.state })); }

  /** `health`: the board's state of each, in this order; without it a sensor is read or missing. */
  show(store, row, health) {
    this.sensors.forEach((sensor, i) => {
      const status = health?.[i];
      // Without the board's health there is no current reading.
      const value = store.count && (status || !health) ? store.column(sensor.column)[row] : NaN;
      const isRead = Number.isFinite(value);
      const state = status?.state ?? (!store.count || health ? '–' : isRead ? 'read' : 'missing');
      const look = LOOKS[state] ?? 'bad';
      const lost = store.count ? lostFor(sensor, store, row, look, isRead) : '';
      const reason = [status?.reason, lost, status?.missed ? `${status.missed} missed` : ''].filter(Boolean).join(', ');
      text(sensor.value, !isRead ? '–' : sensor.kind === 'imu' ? `${minus(value.toFixed(1))}°` : `${value} counts`);
      text(sensor.state, state);
      text(sensor.reason, reason);
      // The board has no such sensor.
      sensor.item.hidden = state === 'NotWired';
      if (sensor.item.dataset.look !== look) sensor.item.dataset.look = look;
    });
  }
}

/** How long a lost sensor has not been read, or, where its readings are not used, has been seen so; else empty. */
function lostFor(sensor, store, row, look, isRead) {
  if (look !== 'bad') {
    sensor.lostAt = NaN;
    return '';
  }
  if (!isRead) sensor.lostAt = lastRead(store, sensor.column, row);
  else if (!(sensor.lostAt <= store.times[row])) sensor.lostAt = store.times[row];
  return `for ${duration(store.times[row] - sensor.lostAt)}`;
}

/** Time of the last reading up to a row, or of the first row. */
function lastRead(store, column, row) {
  const values = store.column(column);
  let last = row;
  while (last > store.begin && !Number.isFinite(values[last])) last--;
  return store.times[last];
}

/** A time in s, for people. */
function duration(seconds) {
  const whole = Math.floor(seconds);
  return whole < 60 ? `${whole} s` : `${Math.floor(whole / 60)} min ${whole % 60} s`;
}

/** Sets a text where it has changed. */
export function text(element, content) {
  if (element.textContent !== content) element.textContent = content;
}
