// Recorded sessions: picked, opened, and loaded again in part.

import { Store, headOf } from './store.js';

const size = (bytes) => (bytes < 1e6 ? `${Math.ceil(bytes / 1e3)} kB` : `${(bytes / 1e6).toFixed(1)} MB`);

/** Fetches a session, or its part between two times. */
export async function load(name, part) {
  const query = new URLSearchParams({ name, ...part });
  const answer = await fetch(`/session?${query}`);
  if (!answer.ok) throw new Error(await answer.text());
  const buffer = await answer.arrayBuffer();
  const { about } = headOf(buffer);
  const store = new Store(about.arm.columns);
  store.load(buffer);
  return { name, store, arm: about.arm, samples: about.samples, every: about.every, marks: about.marks, findings: about.findings };
}

/** The dialog that lists the sessions that can be opened. */
export class SessionPicker {
  constructor(dialog, chosen) {
    this.dialog = dialog;
    this.chosen = chosen;
    this.note = dialog.querySelector('#sessions-note');
    this.files = dialog.querySelector('#files');
    this.file = dialog.querySelector('#file');
    this.file.addEventListener('change', () => this.send(this.file.files[0]));
  }

  async show() {
    this.dialog.showModal();
    this.files.replaceChildren();
    const files = await (await fetch('/sessions')).json();
    this.note.textContent = files.length ? '' : 'There is no session (.csv, .mcap, .bin) in the folder of this monitor.';
    for (const { name, bytes } of files) {
      const button = Object.assign(document.createElement('button'), { textContent: `${name}, ${size(bytes)}` });
      button.addEventListener('click', () => this.open(name));
      this.files.appendChild(document.createElement('li')).append(button);
    }
  }

  async send(file) {
    if (!file) return;
    await this.attempt(`sending ${file.name} …`, async () => {
      const query = new URLSearchParams({ name: file.name });
      const answer = await fetch(`/sessions?${query}`, { method: 'POST', body: file });
      if (!answer.ok) throw new Error(await answer.text());
    });
    if (!this.note.dataset.failed) await this.open(file.name);
    this.file.value = '';
  }

  async open(name) {
    await this.attempt(`opening ${name} …`, async () => {
      this.chosen(await load(name, {}));
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
