// Board and link, in words and numbers.

import { minus } from './plot.js';
import { text } from './sensors.js';

/** Id, name and text of each value; the text is `undefined` where the value is not known. */
const VALUES = [
  ['line', 'Line', (s) => (s.port ? `${s.port}${s.answers ? '' : ', no answer to requests'}` : 'gone')],
  ['who', 'Board', (s) => s.board && `arm ${s.board.arm} (${s.board.segments} segments, ${s.board.bend_sensors} bend sensors, ${s.board.regulators} regulators), firmware ${s.board.firmware}, boot ${s.board.boot} by ${s.board.reset}`],
  ['table', 'Table', (s) => s.board && (s.board.table ? `${s.board.table}${s.offers_table ? ', not the one of this page' : ''}` : 'none')],
  ['panic', 'Last panic', (s) => s.board && (s.board.last_panic ?? 'none')],
  ['rates', 'Rates', (s) => `${s.samples_hz.toFixed(1)} samples/s, ${s.estimates_hz.toFixed(1)} estimates/s, ${(s.bytes_per_s / 1e3).toFixed(1)} kB/s`],
  ['received', 'Frames', (s) => `${s.frames} received, ${s.damaged} damaged, ${s.lost} lost`],
  ['restarts', 'Restarts', (s) => String(s.restarts)],
  ['load', 'CPU load', (s) => s.health && `${s.health.load_percent.toFixed(1)} %, estimate at most ${s.health.longest_tick_ms.toFixed(1)} ms after the tick`],
  ['trouble', 'Since boot', (s) => s.health && `${s.health.overruns} overruns, ${s.health.dropped_frames} frames dropped, ${s.health.bus_recoveries} bus recoveries, ${s.health.saturations} saturations`],
  ['clock', 'Board\'s clock', (s) => s.clock && `began ${new Date(s.clock.zero_ms).toISOString().slice(11, 23)} UTC, ${drift(s.clock.drift)}`],
  ['latency', 'Sample to screen', (s, { latency: l }) => l && `${[[l.p5_ms, 'at 5 %'], [l.p50_ms, 'median'], [l.p95_ms, 'at 95 %'], [l.p99_ms, 'at 99 %'], [l.largest_ms, 'largest']].map(([ms, at]) => `${ms.toFixed(0)} ms ${at}`).join(', ')}${s.least_delay_ms ? `; ${s.least_delay_ms.toFixed(1)} ms of it computed` : ''}`],
  ['slow', 'Too slow', (s) => (s.dropped_events ? `${s.dropped_events} events dropped by this machine` : 'nothing dropped')],
  ['recording', 'Recording', (s) => (s.recording ? recording(s.recording) : 'none')],
];

const signed = (value) => (value < 0 ? '' : '+') + minus(value.toFixed(1));

const drift = (of) => (of ? `${signed(of.board_ppm)} ± ${of.error_ppm.toFixed(1)} ppm fast, over ${of.seconds.toFixed(0)} s` : 'drift known after 40 s');

function recording({ file, is_comparable, samples, marks, dropped_events, failed }) {
  if (failed) return `${file} FAILED: ${failed}`;
  const dropped = dropped_events ? `, ${dropped_events} events not written` : '';
  const tare = is_comparable ? '' : ', cannot be compared with a replay before the next tare';
  return `${file}, ${samples} samples, ${marks} marks${dropped}${tare}`;
}

export class BoardPanel {
  constructor(list, notes) {
    this.notes = notes;
    this.values = VALUES.map(([id, name]) => add(list, id, name));
    this.page = add(list, 'page', 'Page');
  }

  /** `delivery`: latency and skipped batches of this page. */
  show(status, delivery) {
    VALUES.forEach(([, , toText], i) => text(this.values[i], (status && toText(status, delivery)) || '–'));
    const notes = status?.notes ?? [];
    if (notes.join() === this.noted) return;
    this.noted = notes.join();
    this.notes.replaceChildren(...notes.map((note) => Object.assign(document.createElement('li'), { textContent: note })));
  }

  showPage(frames, rows, skipped) {
    text(this.page, `${frames} frames/s, ${rows} rows${skipped ? `, ${skipped} ${skipped === 1 ? 'batch' : 'batches'} skipped` : ''}`);
  }
}

function add(list, id, name) {
  list.append(Object.assign(document.createElement('dt'), { textContent: name }));
  const value = Object.assign(document.createElement('dd'), { id: `fact-${id}`, textContent: '–' });
  list.append(value);
  return value;
}
