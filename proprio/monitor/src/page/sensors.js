// A strip for each sensor: value, state, reason.

import { minus } from './plot.js';

/** How a state looks; whatever is not here is bad. */
const LOOKS = { Ok: 'ok', Slow: 'warn', Intermittent: 'warn', read: 'ok', missing: 'bad', '–': 'none' };

export class Strips {
  constructor(list) {
    this.list = list;
    this.strips = [];
  }

  /** One for each bend sensor, then one for each IMU. */
  build(names) {
    const sensors = names.filter((name) => /^(bend\d+[ab]_adc|imu\d+_deg)$/.test(name));
    this.list.replaceChildren();
    this.strips = sensors.map((column) => {
      const [, kind, number] = column.match(/^(bend|imu)(\d+[ab]?)/);
      const item = document.createElement('li');
      const part = (tag, className) => item.appendChild(Object.assign(document.createElement(tag), { className }));
      part('b', 'name').textContent = `${kind === 'imu' ? 'IMU' : 'bend'} ${number}`;
      const strip = { column, kind, item, value: part('span', 'value'), state: part('span', 'state'), reason: part('span', 'reason') };
      item.id = `strip-${kind}${number}`;
      this.list.append(item);
      return strip;
    });
  }

  /** `health`: what the board says of each, in this order; without it a sensor is read or missing. */
  show(store, row, health) {
    this.strips.forEach((strip, i) => {
      const told = health?.[i];
      // A board that says nothing of itself reads nothing either.
      const value = store.count && (told || !health) ? store.column(strip.column)[row] : NaN;
      const isRead = Number.isFinite(value);
      const state = told?.state ?? (!store.count || health ? '–' : isRead ? 'read' : 'missing');
      const reason = told ? [told.reason, told.missed ? `${told.missed} missed` : ''].filter(Boolean).join(', ') : '';
      text(strip.value, !isRead ? '–' : strip.kind === 'imu' ? `${minus(value.toFixed(1))}°` : `${value} counts`);
      text(strip.state, state);
      text(strip.reason, reason);
      const look = LOOKS[state] ?? 'bad';
      if (strip.item.dataset.look !== look) strip.item.dataset.look = look;
    });
  }
}

/** Sets a text where it has changed. */
export function text(element, content) {
  if (element.textContent !== content) element.textContent = content;
}
