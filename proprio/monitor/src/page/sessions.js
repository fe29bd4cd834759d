// Recorded sessions: picked, opened, and loaded again in part.

import { Store, headOf } from './store.js';

const size = (bytes) => (bytes < 1e6 ? `${Math.ceil(bytes / 1e3)} kB` : `${(bytes / 1e6).toFixed(1)} MB`);

/** Fetches a session, or its part between two times; with the name of a table, by that in place of its own. */
export async function load(name, part, table) {
  const query = new URLSearchParams({ name, ...part, ...(table && { table }) });
  const answer = await fetch(`/session?${query}`);
  if (!answer.ok) throw new Error(await answer.text());
  const buffer = await answer.arrayBuffer();
  const { about } = headOf(buffer);
  const store = new Store(about.arm.columns);
  store.load(buffer);
  return { name, table, store, arm: about.arm, samples: about.samples, every: about.every, marks: about.marks, findings: about.findings };
}

/** The dialog that lists the sessions that can be opened. */
export class SessionPicker {
  /** `chosen(session)` opens it, `laidOver(session)` lays it over the one that is open. */
  constructor(dialog, chosen, laidOver) {
    Object.assign(this, { dialog, chosen, laidOver });
    this.table = dialog.querySelector('#with-table');
    this.note = dialog.querySelector('#sessions-note');
    this.files = dialog.querySelector('#files');
    this.file = dialog.querySelector('#file');
    this.file.addEventListener('change', () => this.send(this.file.files[0]));
  }

  /** `isOpen`: a session is open, over which another can be laid. */
  async show(isOpen) {
    this.dialog.showModal();
    this.files.replaceChildren();
    const all = await (await fetch('/sessions')).json();
    const isTable = ({ name }) => /\.toml$/i.test(name), files = all.filter((file) => !isTable(file));
    const option = (value, textContent) => Object.assign(document.createElement('option'), { value, textContent });
    this.table.replaceChildren(option('', 'its own, or that of the monitor'), ...all.filter(isTable).map(({ name }) => option(name, name)));
    this.note.textContent = files.length ? '' : 'There is no session (.csv, .mcap, .bin) in the folder of this monitor.';
    for (const { name, bytes } of files) {
      const button = (textContent, act) => {
        const made = Object.assign(document.createElement('button'), { textContent });
        made.addEventListener('click', () => this.open(name, act));
        return made;
      };
      const item = this.files.appendChild(document.createElement('li'));
      item.append(button(`${name}, ${size(bytes)}`, this.chosen));
      if (!isOpen) continue;
      const over = button('Lay over', this.laidOver);
      over.setAttribute('aria-label', `Lay ${name} over the session that is open`);
      item.append(over);
    }
  }

  async send(file) {
    if (!file) return;
    await this.attempt(`sending ${file.name} …`, async () => {
      const query = new URLSearchParams({ name: file.name });
      const answer = await fetch(`/sessions?${query}`, { method: 'POST', body: file });
      if (!answer.ok) throw new Error(await answer.text());
    });
    if (!this.note.dataset.failed) await this.open(file.name, this.chosen);
    this.file.value = '';
  }

  async open(name, act) {
    await this.attempt(`opening ${name} …`, async () => {
      act(await load(name, {}, this.table.value));
      this.dialog.close();
    });
  }

  async attempt(what, work) {
    this.note.textContent = what;
    delete this.note.dataset.failed;
    try {
      await work();
    } catch (error) {
      this.note.dataset.failed = 'yes';
      this.note.textContent = error.message;
    }
  }
}
