// Guide through a sweep for a calibration: what was covered, what is missing, and what comes next.

import { clock, minus } from './plot.js';
import { text } from './sensors.js';

/** Name of the choices in the browser's storage. */
const STORED = 'proprio.sweep';
/** A gap in a range that is narrower counts as seen, degrees. */
const GAP = 3;
/** Time at rest at the begin, s: more than a tare. */
const REST = 5;

const degrees = (value) => `${minus(value.toFixed(0))}°`;
const part = ([from, to]) => `${degrees(from)} to ${degrees(to)}`;

/** The parts of −reach to reach that are not in `seen`, degrees. */
export function missing(seen, reach) {
  const found = [];
  let from = -reach;
  for (const [low, high] of [...seen, [reach, reach]]) {
    const to = Math.min(low, reach);
    if (to - from >= GAP) found.push([from, to]);
    from = Math.max(from, high);
  }
  return found;
}

/** In words, the segments that lack something; nothing where none does. */
function more(what, segments, isLacking) {
  const numbers = segments.flatMap((segment, i) => (isLacking(segment) ? [i + 1] : []));
  return numbers.length ? [`more ${what} of segment${numbers.length > 1 ? 's' : ''} ${numbers.join(', ')}`] : [];
}

/** The sentences about a sweep that is not as it should be: sensors, pose, and what `calibrate` will refuse or warn of. */
export function warnings(sweep, bad) {
  const { goal, rest, segments, coupled, phase, bad_tare } = sweep;
  const found = [bad, ...sweep.faults].filter(Boolean);
  if (rest?.turned_deg > goal.still_deg) found.push(`The arm moved in the first second, imu${rest.segment} by ${degrees(rest.turned_deg)}, which is its tare: let it rest, and begin again.`);
  if (bad_tare.length) found.push(`The arm was bent or moving in the board's tare, by segment ${bad_tare.join(', ')}: tare it straight and still.`);
  if (phase === 'before' || sweep.seconds < REST) return found;
  if (phase === 'recorded') {
    segments.forEach(({ ends_deg }, i) => {
      if (!ends_deg) return;
      const range = ends_deg[1] - ends_deg[0];
      if (range < goal.least_range_deg) found.push(`Segment ${i + 1} bends by ${degrees(range)} in all: calibrate refuses less than ${degrees(goal.least_range_deg)}.`);
      else if (range < goal.good_range_deg) found.push(`Segment ${i + 1} bends by ${degrees(range)} in all: the maps will not be reliable beyond that.`);
    });
  }
  if (coupled.length) found.push(`Segments ${coupled.map((pair) => pair.join(' and ')).join(', ')} bend alike: move them at different pace if they can; otherwise exchanged sensors between them stay unnoticed.`);
  return found;
}

/** The step, in one sentence, and what is still to be done. */
export function step(sweep, reach, hasCamera) {
  const { phase, seconds, goal, segments } = sweep;
  if (phase === 'before') {
    return { now: `Let the arm lie straight and still. ${hasCamera ? 'Start the camera, then record the sweep' : 'Record the sweep'}, and leave the arm still for five seconds.`, left: '' };
  }
  const left = [
    ...(seconds < goal.seconds ? [`${clock(goal.seconds - seconds, 1)} to go`] : []),
    ...more('range', segments, ({ ends_deg, seen_deg }) => ends_deg && missing(seen_deg, reach).length),
    ...more('passes', segments, ({ passes }) => passes < goal.passes),
  ].join('; ');
  if (phase === 'recorded') return { now: left ? 'The recording has ended before all was covered.' : 'The sweep is complete.', left };
  if (seconds < REST) return { now: 'Leave the arm still.', left: `${Math.ceil(REST - seconds)} s` };
  if (left) return { now: 'Move each module slowly through its whole range and back, a swing in 20 to 40 s, modules at different pace.', left };
  return { now: `All is covered. Let the arm rest and end the recording${hasCamera ? ', then stop the camera' : ''}.`, left };
}

/** Commands after the recording `file`, each with its purpose. */
export function commands(file, hasCamera) {
  const name = /^[\w./-]+$/.test(file) ? file : `"${file}"`;
  if (!hasCamera) {
    return [
      [`proprio replay ${name} --table imus.toml`, 'the shape by the IMUs alone: an arm description whose segments have bend = []'],
      [`proprio check ${name} --table OTHER.toml`, 'whether the maps of another arm of the same build fit this one'],
      ['proprio table push OTHER.toml', 'stores them on the board, if they do'],
    ];
  }
  return [
    [`proprio align ${name} --camera CAMERA.csv --arm arm.toml -o sweep.csv`, 'brings the camera\'s poses and the recording to one clock'],
    ['proprio calibrate sweep.csv --arm arm.toml -o calibrated.toml', 'fits the maps of the bend sensors'],
    ['proprio table push calibrated.toml', 'stores the table on the board'],
  ];
}

const element = (tag, properties = {}) => Object.assign(document.createElement(tag), properties);

export class SweepGuide {
  /** `record()` begins and ends a recording. */
  constructor(section, button, record) {
    Object.assign(this, { section, button, segments: [], shown: '' });
    const get = (id) => section.querySelector(`#${id}`);
    this.parts = Object.fromEntries(['step', 'left', 'tare', 'warnings', 'next', 'record', 'reach', 'truth'].map((id) => [id, get(`sweep-${id}`)]));
    this.rows = section.querySelector('tbody');
    const { reach, truth } = this.parts;
    try {
      const stored = JSON.parse(localStorage.getItem(STORED)) ?? {};
      if (stored.reach > 0) reach.value = stored.reach;
      if (stored.truth === 'none') truth.value = 'none';
    } catch {
      // Another program's value, or a browser without storage.
    }
    for (const input of [reach, truth]) {
      input.addEventListener('change', () => {
        localStorage.setItem(STORED, JSON.stringify({ reach: Number(reach.value), truth: truth.value }));
        this.show(this.status, this.bad);
      });
    }
    this.parts.record.addEventListener('click', record);
    button.addEventListener('click', () => this.toggle());
    get('sweep-close').addEventListener('click', () => {
      this.toggle();
      button.focus();
    });
  }

  toggle() {
    this.section.hidden = !this.section.hidden;
    this.button.setAttribute('aria-expanded', !this.section.hidden);
    this.show(this.status, this.bad);
  }

  /** `status`: that of board and link; `bad`: sensors that are lost, in one sentence. */
  show(status, bad) {
    Object.assign(this, { status, bad });
    if (this.section.hidden) return;
    const sweep = status?.sweep, { parts } = this;
    parts.record.disabled = !status || Boolean(status.waiting);
    text(parts.record, sweep?.phase === 'recording' ? 'End the recording' : sweep?.phase === 'recorded' ? 'Record again' : 'Record the sweep');
    if (!sweep) {
      text(parts.step, 'No samples yet.');
      text(parts.left, '');
      return;
    }
    const reach = Math.min(170, Math.max(5, Number(parts.reach.value) || 45)), hasCamera = parts.truth.value === 'camera';
    const { now, left } = step(sweep, reach, hasCamera);
    text(parts.step, now);
    text(parts.left, left);
    const tare = sweep.tare ? `Board ${sweep.tare}.` : 'Board not tared since its start.';
    const begin = sweep.phase === 'before' ? 'since then' : 'of the recording';
    text(parts.tare, sweep.rest ? `${tare} First second ${begin}: still within ${sweep.rest.turned_deg.toFixed(1)}° (imu${sweep.rest.segment}).` : tare);
    this.list(parts.warnings, warnings(sweep, bad).map((sentence) => [sentence]));
    this.table(sweep, reach);
    this.next(sweep, hasCamera);
  }

  /** Shows sentences or commands, each with its explanation, where they have changed. */
  list(list, items) {
    const key = JSON.stringify(items);
    if (list.dataset.shown === key) return;
    list.dataset.shown = key;
    list.hidden = !items.length;
    list.replaceChildren(...items.map(([main, about]) => {
      const item = element('li');
      item.append(...(about ? [element('code', { textContent: main }), element('span', { textContent: about })] : [main]));
      return item;
    }));
  }

  table({ segments, goal }, reach) {
    if (this.segments.length !== segments.length) {
      this.segments = segments.map((_, i) => {
        const row = element('tr'), bar = element('div', { className: 'range' }), marker = element('i', { className: 'now' });
        row.append(element('th', { scope: 'row', textContent: `${i + 1}` }), ...Array.from({ length: 6 }, () => element('td')));
        row.children[1].append(bar);
        row.dataset.series = (i % 8) + 1;
        return { row, bar, marker };
      });
      this.rows.replaceChildren(...this.segments.map(({ row }) => row));
    }
    const ends = segments.flatMap(({ ends_deg }) => ends_deg ?? []);
    const widest = Math.max(reach, ...ends.map(Math.abs)) * 1.05;
    segments.forEach((segment, i) => this.row(this.segments[i], segment, { goal, reach, widest }));
  }

  row({ row, bar, marker }, { ends_deg, seen_deg, now_deg, passes, counts }, { goal, reach, widest }) {
    const gaps = ends_deg ? missing(seen_deg, reach) : [];
    const place = (className, [from, to]) => {
      const piece = element('span', { className });
      piece.style.left = `${50 + (50 * from) / widest}%`;
      piece.style.width = `${(50 * (to - from)) / widest}%`;
      return piece;
    };
    marker.hidden = !Number.isFinite(now_deg);
    marker.style.left = `${50 + (50 * (now_deg ?? 0)) / widest}%`;
    bar.replaceChildren(place('wanted', [-reach, reach]), ...seen_deg.map((range) => place('seen', range)), marker);
    const cells = [...row.children].slice(2);
    const values = [
      ends_deg ? seen_deg.map(part).join(', ') || part(ends_deg) : 'no IMU at both ends',
      ends_deg ? gaps.map(part).join(', ') || 'nothing' : 'not known',
      `${passes} of ${goal.passes}`,
      ...counts.map((range) => (range ? `${range[0]} to ${range[1]}` : '–')),
    ];
    values.forEach((value, k) => text(cells[k], value));
    row.dataset.isDone = !gaps.length && passes >= goal.passes;
  }

  next({ phase, file }, hasCamera) {
    const { next } = this.parts, isShown = phase === 'recorded' || !hasCamera;
    next.hidden = !isShown;
    if (!isShown) return;
    const [about, list] = next.children;
    const limits = 'Without a camera there is no truth, and calibrate cannot fit the maps of the bend sensors. What can be done: tare, this check of the sensors, the shape by the IMUs alone, which drifts, and the maps of another arm of the same build, if its strips are like these.';
    text(about, hasCamera ? `Recorded: ${file}. Next, in a terminal, with the camera's file and the arm description:` : limits);
    this.list(list, commands(file ?? 'SESSION.mcap', hasCamera));
  }
}
