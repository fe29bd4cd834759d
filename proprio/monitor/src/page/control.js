// Control of the board, with the token: pressures and tare.

import { post } from './feed.js';

/** Period of the set-points, ms; the board holds them for 500 ms. */
const REFRESH = 150;
const LARGEST_KPA = 280;
/** Time in which a second press tares an arm that moves, ms. */
const ANYWAY = 5000;

export class Control {
  constructor(section, showError, showNotice) {
    this.section = section;
    this.showError = showError;
    this.showNotice = showNotice;
    this.part = (id) => section.querySelector(id);
    this.button = document.getElementById('vent');
    this.tareButton = document.getElementById('tare');
    this.tareButton.addEventListener('click', () => this.tare());
    this.tableButton = document.getElementById('push-table');
    this.tableButton.addEventListener('click', () => this.pushTable());
    this.takeToken();
    this.isDriving = false;
    this.part('#unlock').addEventListener('submit', (event) => {
      event.preventDefault();
      this.unlock(this.part('#token').value.trim());
    });
    this.part('#arm-pressures').addEventListener('click', () => this.arm());
    this.button.addEventListener('click', () => this.vent());
    this.sliders = [];
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
    this.button.disabled = this.tareButton.disabled = this.tableButton.disabled = !this.token;
  }

  /** Makes a slider for each regulator of the board: two for each module, right and left. */
  buildSliders(regulators) {
    if (regulators === this.sliders.length) return;
    this.part('#regulators').replaceChildren();
    this.sliders = Array.from({ length: regulators }, (_, i) => this.slider(`module ${(i >> 1) + 1} ${i % 2 ? 'left' : 'right'}`, i));
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

  /** Shows the board's status; pressures can be set only while it is armed. `offersTable`: the board has another table. */
  status(arm, health, offersTable) {
    this.tableButton.hidden = !arm.allows_control || !offersTable;
    this.section.hidden = this.button.hidden = this.tareButton.hidden = !arm.allows_control;
    this.lock();
    if (health) this.buildSliders(health.pressures_kpa.length);
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

  /** Sends a request to the board; returns its answer, or false after an error, which is shown. */
  async send(command, path = '/control') {
    try {
      return (await post(path, command, this.token)) ?? true;
    } catch (error) {
      if (error.status === 401) this.setToken(null);
      this.showError(error.message);
      return false;
    }
  }

  /** Tares the board. It refuses while the arm moves; a second press within some seconds tares it anyway. */
  async tare() {
    const force = performance.now() < this.anywayUntil;
    this.setAnyway(false);
    const outcome = await this.send({ force }, '/tare');
    if (!outcome) return;
    this.setAnyway(outcome.is_moving);
    this.showNotice(outcome.text);
  }

  setAnyway(isOffered) {
    this.tareButton.textContent = isOffered ? 'Tare anyway' : 'Tare';
    this.anywayUntil = isOffered ? performance.now() + ANYWAY : 0;
    clearTimeout(this.anywayTimer);
    if (isOffered) this.anywayTimer = setTimeout(() => this.setAnyway(false), ANYWAY);
  }

  /** Stores the table of this page on the board, which restarts with it. */
  async pushTable() {
    const text = await this.send(null, '/table');
    if (text) this.showNotice(text);
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
