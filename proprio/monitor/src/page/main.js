// The page: its data and its parts, drawn when they change.

import { Store } from './store.js';
import { Feed, post } from './feed.js';
import { armValues, drawArm } from './arm.js';
import { PLOTS, Range, clock, drawPlot, extent, fit, innerWidth, visible } from './plot.js';
import { View, handle } from './view.js';
import { SensorList, text } from './sensors.js';
import { FindingList } from './findings.js';
import { BoardPanel } from './board_panel.js';
import { SessionPicker, load } from './sessions.js';
import { Control } from './control.js';
import { SvgContext, csv, save } from './export.js';

const $ = (id) => document.getElementById(id);

/** Period of the parts that are not drawn with every row, ms. */
const PERIOD = 100;
/** Number of the segments' colours in style.css. */
const SERIES = 8;

const app = {
  arm: null, status: null, live: null, session: null,
  view: new View(), isFixed: false, isPlaying: false, hidden: new Set(), marks: [],
  uncertainty: null, contact: null,
  /** The user has changed something; new rows have come. */
  isDirty: true, isNew: false, newest_us: 0, drawn: 0, skipped: 0,
  /** The rows that are shown: of a session, or live. */
  get store() { return this.session?.store ?? this.live; },
  changed() { this.isDirty = true; },
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
const sessionPicker = new SessionPicker($('sessions'), () => app.arm?.opens_sessions, openSession);
const plots = PLOTS.map(figure);

const feed = new Feed({
  arm(arm) {
    app.arm = arm;
    if (app.live?.names.join() !== arm.columns.join()) {
      app.live = new Store(arm.columns);
      build();
    }
    for (const id of ['record', 'mark', 'board']) $(id).hidden = !arm.is_live;
    linkState(arm.is_live ? 'wait' : 'ok', arm.is_live ? 'waiting for the board' : 'sessions only');
    if (arm.session && !app.session) load(arm.session, {}).then(openSession, (error) => showError(error.message));
  },
  history(buffer) {
    app.live.load(buffer);
    app.changed();
  },
  rows({ rows, newest_us, uncertainty, contact }) {
    for (const [time, values] of rows) {
      // The history may contain it.
      if (!(time <= app.live.last)) app.live.push(time, values);
    }
    Object.assign(app, { newest_us, uncertainty: uncertainty ?? app.uncertainty, contact: contact ?? app.contact });
    if (!app.session && app.view.isFollowing) app.isNew = true;
  },
  status(status) {
    app.status = status;
    const name = status.board ? status.board.arm : '';
    if (!app.session) text($('arm-name'), name);
    if (!status.port) linkState('bad', 'line gone, waiting');
    else if (status.samples_hz > 0) linkState('ok', 'live');
    else linkState('wait', 'no samples');
    const load = status.health ? `, load ${status.health.load_percent.toFixed(1)} %` : '';
    text($('glance'), `${status.samples_hz.toFixed(0)} samples/s, ${status.lost} lost${load}`);
    recordState(Boolean(status.recording && !status.recording.failed), true);
    control.status(app.arm, status.health, status.offers_table);
  },
  skipped(messages) { app.skipped += messages; },
  gone() {
    app.status = null;
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

function figure(spec) {
  const element = document.createElement('figure');
  const canvas = Object.assign(document.createElement('canvas'), { tabIndex: 0 });
  canvas.setAttribute('role', 'img');
  canvas.setAttribute('aria-label', `${spec.title}, ${spec.unit}, over time`);
  element.append(Object.assign(document.createElement('figcaption'), { textContent: `${spec.title}, ${spec.unit}` }), canvas);
  $('figures').append(element);
  const range = new Range(spec.least);
  handle(canvas, app, range);
  return { ...spec, canvas, range };
}

// Sessions

function openSession(session) {
  app.session = session;
  Object.assign(app, { isPlaying: false, uncertainty: null, contact: null });
  app.view.span = 0;
  app.view.follow();
  app.view.seek(session.store, session.store.first);
  app.view.end = session.store.last;
  plots.forEach(({ range }) => range.reset());
  $('span').value = '0';
  $('close-session').hidden = !app.arm?.is_live;
  text($('arm-name'), session.name);
  $('thinned').hidden = session.every === 1;
  text($('thinned').firstElementChild, `Every ${session.every}th of ${session.samples} samples is shown.`);
  build();
}

function closeSession() {
  app.session = null;
  app.view.span = 30;
  app.view.follow();
  $('span').value = '30';
  $('close-session').hidden = true;
  $('thinned').hidden = true;
  plots.forEach(({ range }) => range.reset());
  build();
}

async function inFull() {
  const [from_s, to_s] = app.view.window(app.store);
  try {
    openSession(await load(app.session.name, { from_s, to_s }));
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
  plots.forEach(({ range }) => range.reset());
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

let palette = colours();
matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => {
  palette = colours();
  app.changed();
});
new ResizeObserver(() => app.changed()).observe(document.body);

function armSpec() {
  const { store } = app;
  const row = store?.count ? store.rowAt(app.view.cursor ?? store.last) : 0;
  const geometry = (app.session ? app.session.arm : app.arm)?.geometry;
  const isNow = !app.session && app.view.isFollowing;
  return { store, row, geometry, colours: palette, ellipseSigmas: app.arm?.ellipse_sigmas, uncertainty: isNow && app.uncertainty, contact: isNow && app.contact };
}

function plotSpec({ prefix, range, canvas }) {
  const { store, view, hidden } = app;
  const [from, to] = wholePixels(view.window(store), innerWidth(canvas));
  const columns = store?.series(prefix, '_deg') ?? [];
  const seen = columns.filter((_, i) => !hidden.has(i));
  const [low, high] = store?.count ? extent(seen, ...visible(store, from, to, view.limit)) : [NaN, NaN];
  if (!app.isFixed) range.follow(low, high);
  const hasTable = Boolean(app.session || app.arm?.opens_sessions);
  const unknown = !store?.count ? 'nothing has come yet' : !hasTable ? 'takes a table: --table TABLE.toml'
    : app.session || prefix === 'theta' ? 'not known here' : 'known from the next tare on';
  const empty = low <= high ? '' : unknown;
  return { store, columns, range, from, to, limit: view.limit, cursor: view.cursor, marks: (app.session ?? app).marks, hidden, colours: palette, empty };
}

/** The window, moved by whole pixels only: rows stay in their columns, and an unchanged picture is not drawn again. */
function wholePixels([from, to], width) {
  const pixel = (to - from) / width;
  const end = Math.ceil(to / pixel) * pixel;
  return [end - (to - from), end];
}

/** Draws the arm, and the plots where they have changed or the newest row is in another column of pixels. */
function draw(isAll) {
  const spec = armSpec();
  drawArm(...fit($('arm-canvas')), spec);
  const [from, to] = app.view.window(app.store);
  const column = Math.ceil(((app.store?.last ?? 0) / (to - from)) * innerWidth(plots[0].canvas));
  if (isAll || column !== drawnTo) for (const plot of plots) drawPlot(...fit(plot.canvas), plotSpec(plot));
  drawnTo = column;
  if (spec.store?.count) text($('arm-values'), armValues(spec.store, spec.row));
  app.drawn++;
}

function drawPeriodic() {
  const { store, view } = app;
  if (!store) return;
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
  $('key-ellipse').hidden = !app.uncertainty;
  $('key-contact').hidden = !app.contact;
  boardPanel.show(app.status);
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
  if (!app.isDirty && !app.isNew) return;
  draw(app.isDirty);
  Object.assign(app, { isDirty: false, isNew: false });
  if (!app.session && app.view.isFollowing && app.newest_us !== seen_us) shown_us = seen_us = app.newest_us;
}
requestAnimationFrame(frame);
setInterval(drawPeriodic, PERIOD);
setInterval(() => {
  boardPanel.showPage(app.drawn, app.store?.count ?? 0, app.skipped);
  app.drawn = 0;
}, 1000);

// Input

function exportCsv() {
  if (app.store?.count) save('proprio.csv', 'text/csv', csv(app.store, ...app.view.window(app.store), app.view.limit));
}

/** The arm and all plots, one below the other, as they are seen. */
function exportSvg() {
  const c = new SvgContext();
  let y = 0, width = 0;
  const add = (canvas, title, drawIt) => {
    c.group(0, y);
    c.fillStyle = palette.ink;
    Object.assign(c, { font: '13px system-ui, sans-serif', textAlign: 'left', textBaseline: 'top' });
    c.fillText(title, 8, 6);
    c.endGroup();
    c.group(0, y + 24);
    drawIt(canvas.clientWidth, canvas.clientHeight);
    c.endGroup();
    y += canvas.clientHeight + 32;
    width = Math.max(width, canvas.clientWidth);
  };
  add($('arm-canvas'), `Arm, ${$('arm-values').textContent}`, (w, h) => drawArm(c, w, h, armSpec()));
  for (const plot of plots) add(plot.canvas, `${plot.title}, ${plot.unit}`, (w, h) => drawPlot(c, w, h, plotSpec(plot)));
  save('proprio.svg', 'image/svg+xml', c.text(width, y, palette.paper));
}

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

const BUTTONS = { pause, record, mark, open: () => attempt(() => sessionPicker.show()), 'close-session': closeSession, reset, csv: exportCsv, svg: exportSvg, 'in-full': inFull };
for (const [id, act] of Object.entries(BUTTONS)) $(id).addEventListener('click', act);
$('fixed').addEventListener('change', ({ target }) => app.fix(target.checked));
$('span').addEventListener('change', ({ target }) => {
  app.view.setSpan(app.store, Number(target.value));
  app.changed();
});
$('scrub').addEventListener('input', ({ target }) => {
  app.isPlaying = false;
  app.view.seek(app.store, Number(target.value));
  app.changed();
});

const KEYS = { ' ': 'pause', r: 'record', m: 'mark', t: 'tare', o: 'open', 0: 'reset', c: 'csv', s: 'svg', f: 'fixed' };
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
