// Control of the pressures, with the token.

import { post } from './feed.js';

/** Period of the set-points, ms; the board holds them for 500 ms. */
const REFRESH = 150;
const LARGEST_KPA = 280;
const NAMES = ['module 1 right', 'module 1 left', 'module 2 right', 'module 2 left', 'module 3 right', 'module 3 left'];

export class Control {
  constructor(section, showError) {
    this.section = section;
    this.showError = showError;
    this.part = (id) => section.querySelector(id);
    this.button = document.getElementById('vent');
    this.takeToken();
    this.isDriving = false;
    this.part('#unlock').addEventListener('submit', (event) => {
      event.preventDefault();
      this.unlock(this.part('#token').value.trim());
    });
    this.part('#arm-pressures').addEventListener('click', () => this.arm());
    this.button.addEventListener('click', () => this.vent());
    this.sliders = NAMES.map((name, i) => this.slider(name, i));
    setInterval(() => this.refresh(), REFRESH);
  }

  /** Takes the token out of the address that was printed, which has it after the #. */
  takeToken() {
    const given = location.hash.match(/^#token=(\w+)$/)?.[1];
    if (given) {
      sessionStorage.setItem('token', given);
      history.replaceState(null, '', location.pathname);
    }
    this.token = null;
    const stored = sessionStorage.getItem('token');
    if (stored) this.unlock(stored);
  }

  /** Takes a token if the server does; a wrong one is shown now, not at the first request that needs it. */
  async unlock(token) {
    try {
      await post('/unlock', null, token);
      this.setToken(token);
    } catch (error) {
      if (error.status) this.setToken(null);
      this.showError(error.message);
    }
  }

  setToken(token) {
    this.token = token || null;
    if (token) sessionStorage.setItem('token', token); else sessionStorage.removeItem('token');
    this.lock();
  }

  lock() {
    this.part('#unlock').hidden = Boolean(this.token);
    this.part('#driving').hidden = !this.token;
    this.button.disabled = !this.token;
  }

  slider(name, i) {
    const id = `regulator${i}`;
    const row = this.part('#regulators').appendChild(document.createElement('p'));
    const label = row.appendChild(Object.assign(document.createElement('label'), { htmlFor: id, textContent: name }));
    const input = row.appendChild(Object.assign(document.createElement('input'), { id, type: 'range', min: 0, max: LARGEST_KPA, step: 1, value: 0, disabled: true }));
    const output = row.appendChild(document.createElement('output'));
    input.addEventListener('input', () => this.show());
    return { label, input, output, board: 0 };
  }

  show() {
    for (const { input, output, board } of this.sliders) output.textContent = `${input.value} kPa, board ${board.toFixed(0)} kPa`;
  }

  /** Shows the board's status; pressures can be set only while it is armed. */
  status(arm, health) {
    this.section.hidden = this.button.hidden = !arm.allows_control;
    this.lock();
    const state = health?.actuation ?? 'no board';
    this.part('#actuation').textContent = state.toLowerCase();
    this.part('#actuation').dataset.state = state === 'Armed' ? 'armed' : 'wait';
    this.part('#arm-pressures').disabled = !health || state === 'Armed';
    if (state === 'Disarmed' || !health) {
      this.isDriving &&= performance.now() < this.armedUntil;
    }
    this.sliders.forEach((slider, i) => {
      slider.board = health?.pressures_kpa[i] ?? 0;
      slider.input.disabled = !this.isDriving;
      if (!this.isDriving) slider.input.value = 0;
    });
    this.show();
  }

  async send(command) {
    try {
      await post('/control', command, this.token);
      return true;
    } catch (error) {
      if (error.status === 401) this.setToken(null);
      this.showError(error.message);
      return false;
    }
  }

  async arm() {
    if (await this.send('arm')) {
      this.isDriving = true;
      // The next status may still be older.
      this.armedUntil = performance.now() + 1000;
    }
  }

  async vent() {
    this.isDriving = false;
    this.sliders.forEach(({ input }) => { input.value = 0; });
    if (this.token) await this.send('vent');
  }

  /** Sends the set-points again, so that the board holds them. A hidden page does not. */
  async refresh() {
    if (!this.isDriving || document.hidden || this.isSending) return;
    this.isSending = true;
    const kpa = this.sliders.map(({ input }) => Number(input.value));
    const sent = await this.send({ set_pressures: { kpa } });
    this.isDriving &&= sent;
    this.isSending = false;
  }
}
