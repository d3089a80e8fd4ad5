// Times of what Bluetooth brings. A page that stalls gets it afterwards, at once; then it is as far apart as it was sent, and time
// itself waits for it: the armband was not silent.

/** Pause between two ticks, and the longest one that is no stall, in ms: so long after a stall, what has waited comes. */
const TICK = 20;
const STALL = 60;
/** Longest pause between two events that have waited, in ms. */
const BURST = 5;

export class Arrival {
  #timer;
  /** When this page did something last, until when what has waited comes, when the newest event came, and the time told last. */
  #awake = performance.now();
  #calm = 0;
  #came = 0;
  #told = performance.now();
  /** Whether events come that have waited. */
  #late = false;

  /** Calls `tick` with a time, again and again. */
  constructor(tick) {
    this.#timer = setInterval(() => {
      const now = this.#wake(STALL);
      // A page that is hidden has timers once a second.
      this.#told = this.#late && !document.hidden ? Math.min(now, this.#told + TICK) : now;
      tick(this.#told);
    }, TICK);
  }

  /** Time now. After a stall, and a pause of the events that have waited, none has. */
  #wake(pause) {
    const now = performance.now();
    if (now - this.#awake > STALL) {
      this.#calm = now + STALL;
      this.#late = true;
    } else if (now > this.#calm && now - this.#came > pause) {
      this.#late = false;
    }
    this.#awake = now;
    return now;
  }

  /** Time of an event that comes now, sent so many ms after the one before. */
  time(period) {
    this.#came = this.#wake(BURST);
    this.#told = this.#late ? Math.min(this.#came, this.#told + period) : this.#came;
    return this.#told;
  }

  stop() {
    clearInterval(this.#timer);
  }
}
