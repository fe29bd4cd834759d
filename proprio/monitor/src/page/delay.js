// The time by which the picture is behind the board.

/** Time over which the least delay of the arrivals is kept, ms. */
const PERIOD = 30_000;
/** Time for which a delay is shown, ms. */
const HOLD = 1500;
/** Least delay that is shown, s. */
const LEAST = 1;

/** Times of samples are by the server's clock, µs; the others by the page's, ms. */
export class Delay {
  constructor() { this.reset(); }

  reset() {
    /** Least difference of the two clocks in this period and the one before: the delay is counted from it. */
    this.least = [Infinity, Infinity];
    this.begun = 0;
    this.largest = 0;
    this.until = 0;
  }

  /** A batch has arrived. */
  arrived(newest_us, now) {
    if (now - this.begun > PERIOD) {
      this.begun = now;
      this.least = [Infinity, this.least[0]];
    }
    this.least[0] = Math.min(this.least[0], now - newest_us / 1000);
  }

  /** The newest sample on the screen, when the next picture is drawn. */
  shown(newest_us, now) {
    const behind = (now - newest_us / 1000 - Math.min(...this.least)) / 1000;
    if (behind < LEAST || !Number.isFinite(behind)) return;
    if (behind > this.largest || now > this.until) this.largest = behind;
    this.until = now + HOLD;
  }

  /** Largest delay of the last moments, s; 0 where it is not worth a word. */
  behind(now) { return now < this.until ? this.largest : 0; }
}
