// The plots that a person has chosen, one below the other, and the values of their curves.

import { KINDS, USUAL, reason } from './catalogue.js';
import { Range, clock, drawPlot, extent, fit, innerWidth, minus, offset, visible } from './plot.js';
import { text } from './sensors.js';
import { handle } from './view.js';

/** Name of the choice in the browser's storage. */
const STORED = 'proprio.plots';

const element = (tag, properties = {}) => Object.assign(document.createElement(tag), properties);

/** The ids of the plots that this browser shows. */
function stored() {
  try {
    const ids = JSON.parse(localStorage.getItem(STORED));
    if (Array.isArray(ids)) return ids.filter((id) => KINDS.some((kind) => kind.id === id));
  } catch {
    // Another program's value, or a browser without storage.
  }
  return USUAL;
}

export class Figures {
  /** `list` is the element of the plots, `menu` the choice of further ones. `app`: as for `handle`, with `point(share)`. */
  constructor(list, menu, app) {
    Object.assign(this, { list, menu, app, figures: [] });
    stored().forEach((id) => this.append(id));
    this.offer();
    menu.addEventListener('change', () => {
      this.append(menu.value).canvas.focus();
      this.chosen();
    });
  }

  append(id) {
    const kind = KINDS.find((one) => one.id === id), title = `${kind.title}, ${kind.unit}`;
    const root = element('figure');
    const caption = element('figcaption');
    const remove = element('button', { textContent: '×', title: 'Remove this plot', className: 'remove' });
    remove.setAttribute('aria-label', `Remove ${title}`);
    caption.append(element('span', { textContent: title }), remove);
    const canvas = element('canvas', { tabIndex: 0 });
    canvas.setAttribute('role', 'img');
    canvas.setAttribute('aria-label', `${title}, over time`);
    const line = element('i', { className: 'pointer', hidden: true }), plot = element('div', { className: 'plot' });
    plot.append(canvas, line);
    const [moment, pointer] = ['moment', 'pointer'].map((name) => element('p', { className: `readings ${name}` }));
    root.append(caption, moment, plot, pointer);
    root.dataset.kind = id;
    this.list.append(root);
    const figure = { kind, title, root, canvas, line, moment, pointer, range: new Range(kind.least), curves: [] };
    handle(canvas, this.app, figure.range);
    remove.addEventListener('click', () => {
      root.remove();
      this.figures.splice(this.figures.indexOf(figure), 1);
      this.menu.focus();
      this.chosen();
    });
    this.figures.push(figure);
    this.buildCurves(figure);
    return figure;
  }

  /** Stores the choice, and draws it. */
  chosen() {
    localStorage.setItem(STORED, JSON.stringify(this.figures.map(({ kind }) => kind.id)));
    this.offer();
    this.app.changed();
  }

  /** Offers the kinds that are not shown. */
  offer() {
    const others = KINDS.filter((kind) => !this.figures.some((figure) => figure.kind === kind));
    const options = others.map(({ id, title, unit }) => element('option', { value: id, textContent: `${title}, ${unit}` }));
    this.menu.replaceChildren(element('option', { value: '', textContent: 'Add a plot …' }), ...options);
    this.menu.value = '';
    this.menu.disabled = !others.length;
  }

  /** Builds the curves for the columns of another arm. */
  build() {
    for (const figure of this.figures) {
      figure.range.reset();
      this.buildCurves(figure);
    }
  }

  buildCurves(figure) {
    const { store, overlay } = this.app;
    const of = (from) => (from ? figure.kind.curves(from) : []).map((curve) => ({ ...curve, store: from, column: from.column(curve.column) })).filter(({ column }) => column);
    figure.curves = of(store);
    figure.overlay = of(overlay?.store).map((curve) => ({ ...curve, isOverlay: true }));
    for (const readings of [figure.moment, figure.pointer]) {
      const values = figure.curves.map((curve) => {
        const value = element('span', { className: curve.isSecond ? 'second' : '' });
        value.dataset.series = (curve.colour % 8) + 1;
        value.append(element('span', { textContent: curve.short }), element('b'));
        return value;
      });
      readings.replaceChildren(element('span', { className: 'at' }), ...values);
    }
  }

  resetRanges() { this.figures.forEach(({ range }) => range.reset()); }

  /** Width of the plots' inside, pixels. */
  get width() { return this.figures.length ? innerWidth(this.figures[0].canvas) : 1; }

  /** Curves of a figure that are seen. */
  seen(curves) { return curves.filter(({ segment }) => !this.app.hidden.has(segment)); }

  /** What `drawPlot` takes of a figure. */
  spec(figure) {
    const { store, view, palette, session, arm, isFixed } = this.app, { range, kind, canvas } = figure;
    const [from, to] = wholePixels(view.window(store), innerWidth(canvas));
    const curves = this.seen([...figure.curves, ...figure.overlay]);
    const extents = curves.map(({ store: own, column }) => extent([column], ...visible(own, from, to, view.limit)));
    const [low, high] = store?.count ? [Math.min(...extents.map(([least]) => least)), Math.max(...extents.map(([, most]) => most))] : [NaN, NaN];
    if (!isFixed) range.follow(low, high);
    const empty = low <= high ? '' : reason(kind.needs, { store, isSession: Boolean(session), hasTable: Boolean(session || arm?.table) });
    const marks = (session ?? this.app).marks;
    return { store, curves, range, from, to, limit: view.limit, cursor: view.cursor, marks, colours: palette, empty };
  }

  draw() {
    for (const figure of this.figures) drawPlot(...fit(figure.canvas), this.spec(figure));
  }

  /** Shows the values at the moment of the arm, and at the pointer in any of the plots, which is a share of the width. */
  showReadings(pointer) {
    const { store, view } = this.app;
    if (!store?.count) return;
    const time = view.cursor ?? view.last(store), row = store.rowAt(time);
    const [from, to] = view.window(store);
    const isPointing = pointer !== null, last = view.last(store);
    const pointed = isPointing ? Math.min(Math.max(from + pointer * (to - from), store.first), last) : NaN;
    for (const figure of this.figures) {
      this.read(figure, figure.moment, row, `${view.cursor === null ? 'now' : 'at'} ${clock(store.times[row])}`);
      if (isPointing) this.read(figure, figure.pointer, store.rowAt(pointed), `cursor ${clock(store.times[store.rowAt(pointed)])}`);
      figure.pointer.classList.toggle('idle', !isPointing);
      figure.line.hidden = !isPointing;
      if (isPointing) figure.line.style.transform = `translateX(${offset(figure.canvas, (pointed - from) / (to - from))}px)`;
    }
  }

  read(figure, readings, row, at) {
    text(readings.firstElementChild, at);
    figure.curves.forEach(({ column, segment, isOptional }, i) => {
      const value = readings.children[i + 1];
      value.hidden = this.app.hidden.has(segment) || (isOptional && !Number.isFinite(column[row]));
      text(value.lastElementChild, shownValue(column[row], figure.kind.digits));
    });
  }

  /** Names and values of the curves that are seen, at one row. */
  legend(figure, row) {
    return this.seen(figure.curves).filter(({ column, isOptional }) => !isOptional || Number.isFinite(column[row])).map(({ name, column, colour, isSecond }) => ({ name, colour, isSecond, value: shownValue(column[row], figure.kind.digits) }));
  }
}

const shownValue = (value, digits) => (Number.isFinite(value) ? minus(value.toFixed(digits)) : '–');

/** The window, moved by whole pixels only: rows stay in their columns, and an unchanged picture is not drawn again. */
function wholePixels([from, to], width) {
  const pixel = (to - from) / width;
  const end = Math.ceil(to / pixel) * pixel;
  return [end - (to - from), end];
}
