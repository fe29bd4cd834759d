// The visible part of the time, and its input.

import { innerWidth, shares } from './plot.js';

/** Shortest span, s. */
const SHORTEST = 0.2;

/** The part of the time that all plots show, and the moment that the arm shows. */
export class View {
  constructor() {
    this.span = 30;
    this.follow();
  }

  /** Moves to the newest row and follows new ones. */
  follow() {
    this.end = null;
    this.cursor = null;
    this.limit = Infinity;
  }

  get isFollowing() { return this.end === null; }

  /** Stops following; later rows are not shown. */
  hold(store) {
    if (this.isFollowing) this.limit = store.last;
    [, this.end] = this.window(store);
    this.cursor ??= Math.min(this.end, this.limit);
  }

  /** Time of the last visible row. */
  last(store) { return Math.min(this.limit, store.last); }

  /** Begin and end; a span of 0 shows all rows. */
  window(store) {
    const last = store?.count ? this.last(store) : 0, first = store?.count ? store.first : 0;
    const span = this.span || Math.max(last - first, SHORTEST);
    // At the begin the picture fills from the left.
    const to = this.end ?? Math.max(last, first + span);
    return [to - span, to];
  }

  /** Changes the span around a share of the width; a window that follows keeps its end. */
  zoom(store, factor, share) {
    const [from, to] = this.window(store);
    const span = Math.max(SHORTEST, (to - from) * factor);
    if (!this.isFollowing) this.end = from + share * (to - from) + (1 - share) * span;
    this.span = span;
  }

  /** Sets the span around the moment that the arm shows, within the rows. */
  setSpan(store, span) {
    if (!this.isFollowing && span) {
      const [from, to] = this.window(store);
      const share = (this.cursor - from) / (to - from);
      this.zoom(store, span / (to - from), Math.min(1, Math.max(0, share)));
      this.end = Math.max(store.first + span, Math.min(this.end, this.last(store)));
    } else if (!this.isFollowing) {
      this.end = this.last(store);
    }
    this.span = span;
  }

  /** Moves to the right by a share of the width and stops following. */
  move(store, share) {
    this.hold(store);
    const [from, to] = this.window(store);
    if (!this.span) this.span = to - from;
    const end = to + share * (to - from);
    this.end = Math.min(Math.max(end, store.first + 0.1 * this.span), this.last(store) + 0.9 * this.span);
  }

  /** Moves the cursor by a number of rows. */
  step(store, rows) {
    this.hold(store);
    const row = store.rowAt(this.cursor) + rows;
    this.seek(store, store.times[Math.min(Math.max(row, store.begin), store.rowAt(this.last(store)))]);
  }

  /** Moves the cursor by a share of the width. */
  page(store, share) {
    const [from, to] = this.window(store);
    this.seek(store, (this.cursor ?? this.last(store)) + share * (to - from));
  }

  /** Moves the cursor to this moment, and the window to the cursor. */
  seek(store, time) {
    this.hold(store);
    this.cursor = Math.min(Math.max(time, store.first), this.last(store));
    const [from, to] = this.window(store);
    if (this.cursor < from || this.cursor > to) this.end = this.cursor < from ? this.cursor + (to - from) : this.cursor;
  }
}

/** Moves the cursor by a key; returns false for a key that does not. */
export function moveByKey({ key }, app) {
  const { view, store } = app;
  const act = {
    ArrowLeft: () => view.step(store, -1),
    ArrowRight: () => view.step(store, 1),
    PageDown: () => view.page(store, -0.1),
    PageUp: () => view.page(store, 0.1),
    Home: () => view.seek(store, store.first),
    End: () => view.seek(store, view.last(store)),
  }[key];
  if (!act || !store?.count) return false;
  app.isPlaying = false;
  act();
  app.changed();
  return true;
}

/**
 * Handles mouse, touch and keys on a plot. `app` has `store`, `view`, `isFixed`, `changed()` and `point(share)`, which takes the
 * pointer's share of the width, or null; `range` is the plot's own.
 */
export function handle(canvas, app, range) {
  const pointers = new Map();
  let moved = 0;

  canvas.addEventListener('wheel', (event) => {
    event.preventDefault();
    const [x, y] = shares(canvas, event);
    const factor = Math.exp((event.deltaY || event.deltaX) * 0.002);
    zoom(event.shiftKey, factor, x, y);
  }, { passive: false });

  canvas.addEventListener('pointerdown', (event) => {
    canvas.setPointerCapture(event.pointerId);
    pointers.set(event.pointerId, event);
    moved = 0;
    app.point(shares(canvas, event)[0]);
  });
  canvas.addEventListener('pointerleave', () => app.point(null));
  canvas.addEventListener('pointermove', (event) => {
    app.point(shares(canvas, event)[0]);
    const before = pointers.get(event.pointerId);
    if (!before) return;
    const [dx, dy] = [event.clientX - before.clientX, event.clientY - before.clientY];
    moved += Math.abs(dx) + Math.abs(dy);
    if (pointers.size === 2) {
      const [a, b] = [...pointers.values()];
      const other = a.pointerId === event.pointerId ? b : a;
      const width = (one) => Math.max(20, Math.abs(one.clientX - other.clientX));
      zoom(false, width(before) / width(event), shares(canvas, other)[0], 0.5);
    } else if (moved > 4 && app.store.count) {
      app.view.move(app.store, -dx / innerWidth(canvas));
      if (app.isFixed) range.move(dy / canvas.getBoundingClientRect().height);
    }
    pointers.set(event.pointerId, event);
    app.changed();
  });
  const release = (event) => {
    // A click without a movement picks a moment.
    if (event.type === 'pointerup' && moved <= 4 && pointers.size === 1 && app.store.count) {
      const [from, to] = app.view.window(app.store);
      app.isPlaying = false;
      app.view.seek(app.store, from + shares(canvas, event)[0] * (to - from));
      app.changed();
    }
    pointers.delete(event.pointerId);
    if (event.pointerType !== 'mouse') app.point(null);
  };
  canvas.addEventListener('pointerup', release);
  canvas.addEventListener('pointercancel', release);

  canvas.addEventListener('keydown', (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    if (moveByKey(event, app)) {
      event.preventDefault();
      return;
    }
    const act = {
      ArrowUp: () => app.isFixed && range.move(0.1),
      ArrowDown: () => app.isFixed && range.move(-0.1),
      '+': () => zoom(event.shiftKey && event.code === 'NumpadAdd', 0.8, 0.5, 0.5),
      '=': () => zoom(false, 0.8, 0.5, 0.5),
      '*': () => zoom(true, 0.8, 0.5, 0.5),
      '-': () => zoom(false, 1.25, 0.5, 0.5),
      _: () => zoom(true, 1.25, 0.5, 0.5),
    }[event.key];
    if (!act) return;
    event.preventDefault();
    act();
    app.changed();
  });

  function zoom(isValue, factor, x, y) {
    if (isValue) {
      app.fix(true);
      range.zoom(factor, y);
    } else {
      app.view.zoom(app.store, factor, x);
    }
    app.changed();
  }
}
