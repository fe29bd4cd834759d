// The page: its data and its parts, drawn when they change.

import { Store } from './store.js';
import { Feed, post } from './feed.js';
import { armValues, contacts, covariances, drawArm } from './arm.js';
import { clock, fit } from './plot.js';
import { Figures } from './figures.js';
import { View, moveByKey } from './view.js';
import { SensorList, text } from './sensors.js';
import { FindingList } from './findings.js';
import { faults } from './faults.js';
import { Delay } from './delay.js';
import { BoardPanel } from './board_panel.js';
import { SessionPicker, load } from './sessions.js';
import { Control } from './control.js';
import { Saver } from './saver.js';
import { SweepGuide } from './sweep.js';

const $ = (id) => document.getElementById(id);

/** Period of the parts that are not drawn with every row, ms. */
const PERIOD = 100;
/** Number of the segments' colours in style.css. */
const SERIES = 8;

const app = {
  arm: null, status: null, live: null, session: null,
  view: new View(), isFixed: false, isPlaying: false, hidden: new Set(), marks: [],
  /** The pointer's share of the plots' width. */
  pointer: null, isPointerNew: false,
  /** The user has changed something; new rows have come. */
  isDirty: true, isNew: false, newest_us: 0, drawn: 0, delivery: { latency: null, skipped: 0 }, palette: null,
  /** The rows that are shown: of a session, or live. */
  get store() { return this.session?.store ?? this.live; },
  /** Another session, or the same by another table, which is drawn over the one that is open. */
  get overlay() { return this.session?.overlay; },
  changed() { this.isDirty = true; },
  point(share) { Object.assign(this, { pointer: share, isPointerNew: true }); },
  fix(isFixed) {
    this.isFixed = isFixed;
    $('fixed').checked = isFixed;
    this.changed();
  },
};

const sensorList = new SensorList($('strips'));
const findingList = new FindingList($('findings'));
const boardPanel = new BoardPanel($('facts'), $('notes'));
const control = new Control($('control'), showError, showNotice);
const sessionPicker = new SessionPicker($('sessions'), openSession, layOver);
const figures = new Figures($('figures'), $('add-plot'), app);
const sweepGuide = new SweepGuide($('sweep'), $('calibrate'), () => record());
const saver = new Saver(app, figures, armSpec, { canvas: $('arm-canvas'), moment: $('moment'), overlay: $('overlay').firstElementChild });
const delay = new Delay();

const feed = new Feed({
  arm(arm) {
    app.arm = arm;
    if (app.live?.names.join() !== arm.columns.join()) {
      app.live = new Store(arm.columns);
      build();
    }
    for (const id of ['record', 'mark', 'calibrate', 'board']) $(id).hidden = !arm.is_live;
    linkState(arm.is_live ? 'wait' : 'ok', arm.is_live ? 'waiting for a board' : 'sessions only');
    if (arm.session && !app.session) load(arm.session, {}).then(openSession, (error) => showError(error.message));
  },
  history(buffer) {
    app.live.load(buffer);
    app.changed();
  },
  arrived(sent_us) { delay.arrived(sent_us, performance.now()); },
  rows({ rows, newest_us }) {
    for (const [time, values] of rows) {
      // The history may contain it.
      if (!(time <= app.live.last)) app.live.push(time, values);
    }
    app.newest_us = newest_us;
    if (!app.session && app.view.isFollowing) app.isNew = true;
  },
  status(status) {
    app.status = status;
    const name = status.board ? status.board.arm : '';
    if (!app.session) text($('arm-name'), name);
    const behind = delay.behind(performance.now());
    if (status.waiting) linkState('wait', 'waiting for a board');
    else if (!status.port) linkState('bad', 'line gone, waiting');
    else if (!(status.samples_hz > 0)) linkState('wait', 'no samples');
    else if (behind) linkState('wait', `behind by ${behind.toFixed(0)} s`);
    else linkState('ok', 'live');
    const load = status.health ? `, load ${status.health.load_percent.toFixed(1)} %` : '';
    text($('glance'), status.waiting ? '' : `${status.samples_hz.toFixed(0)} samples/s, ${status.lost} lost${load}`);
    recordState(Boolean(status.recording && !status.recording.failed), !status.waiting);
    control.status(app.arm, status.health, status.offers_table);
  },
  delivery(delivery) { app.delivery = delivery; },
  gone() {
    app.status = null;
    delay.reset();
    linkState('bad', 'monitor is not running');
    text($('glance'), '');
    recordState(false, false);
    if (app.arm) control.status(app.arm, null, false);
  },
});

function linkState(state, what) {
  $('link').dataset.state = state;
  document.body.toggleAttribute('data-stale', state === 'bad' && !app.session);
  text($('link'), what);
}

function recordState(isRecording, isPossible) {
  $('record').setAttribute('aria-pressed', isRecording);
  $('record').disabled = !isPossible;
  text($('record'), isRecording ? 'Stop recording' : 'Record');
  $('mark').disabled = !isRecording;
}

/** Shows an error until the next action, or for some seconds. */
function showError(message) { showNotice(message, 'error'); }

/** Shows a sentence in the same way. */
function showNotice(message, kind = 'done') {
  text($('notice'), message);
  $('notice').dataset.kind = kind;
  $('notice').hidden = !message;
  clearTimeout(showNotice.timer);
  if (message) showNotice.timer = setTimeout(() => showNotice(''), 8000);
}

/** Builds the parts for another arm: sensors, and the legend that shows and hides segments. */
function build() {
  sensorList.build(app.store.names);
  figures.build();
  const segments = app.store.series('theta', '_deg').length;
  app.hidden.clear();
  $('segments').replaceChildren(...Array.from({ length: segments }, (_, i) => {
    const button = Object.assign(document.createElement('button'), { textContent: `segment ${i + 1}` });
    button.dataset.series = (i % SERIES) + 1;
    button.setAttribute('aria-pressed', 'true');
    button.addEventListener('click', () => {
      if (!app.hidden.delete(i)) app.hidden.add(i);
      button.setAttribute('aria-pressed', !app.hidden.has(i));
      app.changed();
    });
    return button;
  }));
  listMarks();
  app.changed();
}

/** Lists the marks, each as a button that moves the cursor to it. */
function listMarks() {
  const { marks } = app.session ?? app;
  $('marks').hidden = !marks.length;
  $('marks').replaceChildren(...marks.map(({ time_s, text }) => {
    const button = Object.assign(document.createElement('button'), { textContent: `${text}, ${clock(time_s)}` });
    button.addEventListener('click', () => {
      app.view.seek(app.store, time_s);
      app.changed();
    });
    return button;
  }));
}

// Sessions

function openSession(session) {
  app.session = session;
  app.isPlaying = false;
  app.view.span = 0;
  app.view.follow();
  app.view.seek(session.store, session.store.firstValue(session.store.series('x', '_mm')));
  app.view.end = session.store.last;
  $('span').value = '0';
  $('close-session').hidden = !app.arm?.is_live;
  text($('arm-name'), session.name);
  $('thinned').hidden = session.every === 1;
  showOverlay();
  text($('thinned').firstElementChild, `Every ${session.every}th of ${session.samples} samples is shown.`);
  build();
  // The time slider has the session's range at once.
  drawPeriodic();
}

function closeSession() {
  app.session = null;
  app.view.span = 30;
  app.view.follow();
  $('span').value = '30';
  $('close-session').hidden = true;
  $('thinned').hidden = true;
  showOverlay();
  build();
}

/** Draws another session over the one that is open, or none. */
function layOver(session) {
  app.session.overlay = session;
  showOverlay();
  figures.build();
  app.changed();
}

function showOverlay() {
  const named = ({ name, arm: { table } }) => `${name} by table ${table}`;
  $('overlay').hidden = !app.overlay;
  if (app.overlay) text($('overlay').firstElementChild, `Solid: ${named(app.session)}. Dashed: ${named(app.overlay)}.`);
}

async function inFull() {
  const [from_s, to_s] = app.view.window(app.store);
  try {
    const { name, table, overlay } = app.session;
    openSession({ ...await load(name, { from_s, to_s }, table), overlay });
  } catch (error) {
    showError(error.message);
  }
}

/** Pauses and resumes; plays a session. */
function pause() {
  if (!app.store?.count) return;
  if (app.session) {
    app.isPlaying = !app.isPlaying;
    if (app.view.cursor >= app.store.last) app.view.seek(app.store, app.store.first);
  } else if (app.view.isFollowing) {
    app.view.hold(app.store);
  } else {
    app.view.follow();
  }
  app.changed();
}

function reset() {
  figures.resetRanges();
  app.fix(false);
  app.view.span = Number($('span').value) || 0;
  if (app.session) app.view.end = app.session.store.last; else app.view.follow();
  app.changed();
}

// Drawing

function colours() {
  const style = getComputedStyle(document.documentElement);
  const get = (name) => style.getPropertyValue(name).trim();
  const series = Array.from({ length: SERIES }, (_, i) => get(`--s${i + 1}`));
  return { series, ink: get('--ink'), faint: get('--faint'), grid: get('--grid'), paper: get('--card'), bad: get('--bad'), trail: get('--trail'), font: 'system-ui, sans-serif' };
}

app.palette = colours();
matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => {
  app.palette = colours();
  app.changed();
});
new ResizeObserver(() => app.changed()).observe(document.body);

function armSpec() {
  const { store } = app;
  const row = store?.count ? store.rowAt(app.view.cursor ?? store.last) : 0;
  const geometry = (app.session ? app.session.arm : app.arm)?.geometry;
  const time = store?.count ? store.times[row] : 0, { overlay } = app;
  const over = overlay?.store.count && { store: overlay.store, row: overlay.store.rowAt(time), geometry: overlay.arm.geometry };
  return { store, row, geometry, colours: app.palette, overlay: over };
}

/** Draws the arm, and the plots where they have changed or the newest row is in another column of pixels. */
function draw(isAll) {
  const spec = armSpec();
  drawArm(...fit($('arm-canvas')), spec);
  const [from, to] = app.view.window(app.store);
  const column = Math.ceil(((app.store?.last ?? 0) / (to - from)) * figures.width);
  if (isAll || column !== drawnTo) figures.draw();
  drawnTo = column;
  if (spec.store?.count) text($('arm-values'), armValues(spec.store, spec.row));
  if (isAll) showMoment();
  app.drawn++;
}

/** The moment that arm and plots show, in words and numbers. */
function showMoment() {
  const { store, view } = app;
  if (!store?.count) return;
  const isNow = view.cursor === null, time = store.times[store.rowAt(view.cursor ?? view.last(store))];
  const before = !app.session && !isNow ? `, ${clock(store.last - time, 0.1)} ago` : '';
  text($('moment'), isNow ? `now, ${clock(time)}` : `at ${clock(time)}${app.isPlaying ? ', playing' : `, picked${before}`}`);
  $('moment').dataset.state = isNow ? 'ok' : 'wait';
  figures.showReadings(app.pointer);
}

function drawPeriodic() {
  const { store, view } = app;
  if (!store) return;
  showMoment();
  const isSession = Boolean(app.session);
  const row = isSession ? store.rowAt(view.cursor ?? store.last) : Math.max(store.begin, store.end - 1);
  sensorList.show(store, row, isSession ? null : app.status?.sensors ?? []);
  const isRunning = isSession ? app.isPlaying : view.isFollowing;
  text($('pause'), isRunning ? 'Pause' : isSession ? 'Play' : 'Resume');
  $('pause').setAttribute('aria-pressed', !isRunning);
  const scrub = $('scrub');
  scrub.disabled = !store.count;
  if (store.count) {
    [scrub.min, scrub.max] = [store.first, view.last(store)];
    const time = view.cursor ?? store.last;
    if (document.activeElement !== scrub || isRunning) scrub.value = time;
    text($('time'), clock(time));
  }
  const at = (name) => store.count && store.column(name) && Number.isFinite(store.column(name)[row]);
  $('key-truth').hidden = !store.names.some((name) => /^truth\d+_x_mm$/.test(name) && at(name));
  const shown = store.count ? store.rowAt(view.cursor ?? store.last) : -1;
  $('key-ellipse').hidden = shown < 0 || !covariances(store, shown).flat().some(Number.isFinite);
  $('key-contact').hidden = shown < 0 || !contacts(store, shown).some(Boolean);
  boardPanel.show(app.status, app.delivery);
  const found = faults(app.status, sensorList.states(app.status?.sensors)), wrong = app.session ? '' : found;
  text($('wrong'), wrong);
  $('wrong').hidden = !wrong;
  sweepGuide.show(app.status, found);
  findingList.show((app.session ?? app.status)?.findings ?? []);
}

let drawnTo = NaN, seen_us = 0, shown_us = 0, played = performance.now();
function frame(now) {
  requestAnimationFrame(frame);
  // The picture of the last frame is on the screen now.
  if (shown_us) feed.shown(shown_us);
  shown_us = 0;
  if (app.isPlaying && app.session) {
    const { store } = app;
    app.view.seek(store, app.view.cursor + (now - played) / 1000);
    if (app.view.cursor >= store.last) app.isPlaying = false;
    app.isDirty = true;
  }
  played = now;
  if (app.isPointerNew) figures.showReadings(app.pointer);
  app.isPointerNew = false;
  if (!app.isDirty && !app.isNew) return;
  draw(app.isDirty);
  Object.assign(app, { isDirty: false, isNew: false });
  if (!app.session && app.view.isFollowing && app.newest_us !== seen_us) shown_us = seen_us = app.newest_us;
}
requestAnimationFrame(frame);
setInterval(drawPeriodic, PERIOD);
setInterval(() => {
  boardPanel.showPage(app.drawn, app.store?.count ?? 0, app.delivery.skipped);
  app.drawn = 0;
}, 1000);

// Input

async function attempt(work) {
  showError('');
  try {
    await work();
  } catch (error) {
    showError(error.message);
  }
}

const record = () => attempt(() => post('/record', { on: $('record').getAttribute('aria-pressed') !== 'true' }));
const mark = () => attempt(async () => {
  const text = `mark ${app.marks.length + 1}`;
  await post('/mark', { text });
  app.marks.push({ time_s: app.live.last, text });
  listMarks();
  app.changed();
});

const BUTTONS = { pause, record, mark, open: () => attempt(() => sessionPicker.show(Boolean(app.session))), 'close-session': closeSession, 'remove-overlay': () => layOver(null), reset, csv: () => saver.csv(), svg: () => saver.picture('svg'), png: () => saver.picture('png'), 'in-full': inFull };
for (const [id, act] of Object.entries(BUTTONS)) $(id).addEventListener('click', act);
$('fixed').addEventListener('change', ({ target }) => app.fix(target.checked));
$('span').addEventListener('change', ({ target }) => {
  app.view.setSpan(app.store, Number(target.value));
  app.changed();
});
$('scrub').addEventListener('keydown', (event) => {
  if (moveByKey(event, app)) event.preventDefault();
});
$('scrub').addEventListener('input', ({ target }) => {
  app.isPlaying = false;
  app.view.seek(app.store, Number(target.value));
  app.changed();
});

const KEYS = { ' ': 'pause', r: 'record', m: 'mark', t: 'tare', k: 'calibrate', o: 'open', 0: 'reset', c: 'csv', s: 'svg', p: 'png', f: 'fixed' };
document.addEventListener('keydown', (event) => {
  if (event.key === 'Escape' && app.arm?.allows_control) control.vent();
  const isTyping = event.target.closest('input:not([type=checkbox], [type=range]), select, dialog');
  const isPressing = event.key === ' ' && event.target.closest('button, input');
  if (isTyping || isPressing || event.ctrlKey || event.metaKey || event.altKey || event.repeat) return;
  const button = $(KEYS[event.key.toLowerCase()]);
  if (!button || button.hidden || button.disabled) return;
  event.preventDefault();
  button.click();
});
