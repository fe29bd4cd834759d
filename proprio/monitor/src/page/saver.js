// Saves what the page shows: rows as CSV, arm and plots as a picture.

import { armValues } from './arm.js';
import { csv, save } from './export.js';
import { picture, toPng, toSvg } from './picture.js';

export class Saver {
  /** `armSpec()` returns what the arm is drawn with; `elements` are the arm's canvas, the text of the moment, and that of what is laid over. */
  constructor(app, figures, armSpec, elements) { Object.assign(this, { app, figures, armSpec, elements }); }

  /** Name of a file: the session and the part of it, or the arm and the time of day, UTC. */
  fileName(ending) {
    const { app } = this;
    const [from, to] = app.view.window(app.store).map((time) => Math.min(Math.max(time, app.store.first), app.view.last(app.store)).toFixed(2));
    const session = app.session?.name.replace(/\.\w+$/, '');
    const name = session ?? `${app.status?.board?.arm || 'arm'}-${new Date().toISOString().slice(0, 19).replaceAll(':', '-')}Z`;
    return `${name}-${from}s-${to}s.${ending}`;
  }

  csv() {
    const { app } = this;
    if (app.store?.count) save(this.fileName('csv'), 'text/csv', csv(app.store, ...app.view.window(app.store), app.view.limit));
  }

  /** Saves a picture of the arm and all plots, one below the other, as they are seen. */
  async picture(ending) {
    const { app, figures, elements } = this;
    if (!app.store?.count) return;
    const { table } = (app.session ? app.session.arm : app.arm) ?? {};
    const what = app.session ? `session ${app.session.name}` : `arm ${app.status?.board?.arm || 'without a name'}`;
    const head = [what, `table ${table ?? 'none'}`, `${elements.moment.textContent}; saved ${new Date().toISOString().slice(0, 19)}Z`];
    if (app.overlay) head.push(elements.overlay.textContent);
    const arm = this.armSpec();
    const armTitle = `Arm, ${armValues(arm.store, arm.row)}`;
    const drawn = picture({ head, arm, armTitle, armSize: elements.canvas, figures, row: arm.row, colours: app.palette });
    if (ending === 'svg') save(this.fileName('svg'), 'image/svg+xml', toSvg(drawn));
    else save(this.fileName('png'), 'image/png', await toPng(drawn));
  }
}
