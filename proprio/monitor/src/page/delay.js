// The time by which rows come late to this page.

/** Time over which the least delay of the batches is kept, ms. */
const PERIOD = 30_000;
/** Time for which a delay is shown, ms. */
const HOLD = 1500;
/** Least delay that is shown, s. */
const LEAST = 1;

export class Delay {
  constructor() { this.reset(); }

  reset() {
    /** Least difference of the page's clock and the server's, in this period and the one before: delays are counted from it. */
    this.least = [Infinity, Infinity];
    this.periodStart = this.until = 0;
    this.largest = 0;
  }

  /** A batch has arrived: its time by the server's clock, µs, and that by the page's, ms. */
  arrived(sent_us, now) {
    if (now - this.periodStart > PERIOD) {
      this.periodStart = now;
      this.least = [Infinity, this.least[0]];
    }
    const difference = now - sent_us / 1000;
    this.least[0] = Math.min(this.least[0], difference);
    const late = (difference - Math.min(...this.least)) / 1000;
    if (late < LEAST) return;
    this.largest = now > this.until ? late : Math.max(late, this.largest);
    this.until = now + HOLD;
  }

  /** Largest delay of the last moments, s; 0 where it is short. */
  behind(now) { return now < this.until ? this.largest : 0; }
}
