// Times of what Bluetooth brings. A page that stalls gets it afterwards, at once; then it is as far apart as it was sent, and time
// itself waits for it: the armband was not silent.

/** Pause between two ticks, and the longest one that is no stall, in ms. */
const TICK = 20;
const STALL = 60;
/** Pause between two notifications of an armband, and the longest one in a burst, in ms. */
const PERIOD = 10;
const BURST = 5;

export class Arrival {
  #timer;
  /** When this page did something last, when the newest event came, and the time that it was given. */
  #awake = performance.now();
  #came = 0;
  #given = -Infinity;
  /** Whether events that have waited are still coming. */
  #late = false;

  /** Calls `tick` with a time, again and again. */
  constructor(tick) {
    this.#timer = setInterval(() => {
      const late = this.#wake() > STALL;
      // What has waited comes first.
      setTimeout(() => {
        this.#late &&= performance.now() - this.#came < STALL;
        tick(this.#late ? this.#given : performance.now());
      }, late ? STALL : 0);
    }, TICK);
  }

  /** Pause since this page did something. */
  #wake() {
    const now = performance.now();
    const pause = now - this.#awake;
    this.#awake = now;
    return pause;
  }

  /** Time of an event that comes now. */
  time() {
    const now = performance.now();
    if (this.#wake() > STALL) {
      this.#late = true;
    } else if (now - this.#came > BURST) {
      this.#late = false;
    }
    this.#came = now;
    this.#given = this.#late ? Math.min(now, this.#given + PERIOD) : now;
    return this.#given;
  }

  stop() {
    clearInterval(this.#timer);
  }
}
