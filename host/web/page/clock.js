// Two clocks on one screen: the server's, and the stream's, which counts samples at 200 Hz.

export const RATE = 200;

// Samples are drawn so much later than they come, in ms, that the picture moves evenly although they come unevenly.
const DELAY = 30;

export class Clock {
  #offset = 0;
  #best = Infinity;
  #stream = null;

  /** The server's time, ms. */
  now() {
    return performance.now() + this.#offset;
  }

  /** Another stream begins. */
  forget() {
    this.#stream = null;
  }

  /** First guess, until a ping has returned. */
  hello(now) {
    this.#offset = now - performance.now();
    this.#best = Infinity;
    this.#stream = null;
  }

  /** The answer to a ping: of the shortest way there and back its middle is known best. */
  pong(sent, now) {
    const received = performance.now();
    const way = received - sent;
    // A long-forgotten best would hold on to a clock that has drifted.
    this.#best *= 1.02;
    if (way <= this.#best) {
      this.#best = way;
      this.#offset = now - (sent + received) / 2;
    }
  }

  /** Samples up to `end` (exclusive) came at `at`. */
  samples(end, at) {
    const position = end - (at * RATE) / 1000;
    const jump = this.#stream === null || Math.abs(position - this.#stream) > RATE / 4;
    this.#stream = jump ? position : this.#stream + 0.02 * (position - this.#stream);
  }

  /** How long ago a position of the stream was recorded, ms. */
  age(position) {
    return this.#stream === null ? null : this.now() - ((position - this.#stream) * 1000) / RATE;
  }

  /** The stream's position now, in samples and parts of one. */
  position() {
    return this.#stream === null ? null : ((this.now() - DELAY) * RATE) / 1000 + this.#stream;
  }
}
