// Rate of the samples, and their way from the program to the picture.

import { t } from "./texts.js";

/** Time over which the rate is measured, in ms. */
const SPAN = 2500;

export class Rates {
  /** [time of arrival in ms, samples] of the newest messages. */
  #arrived = [];
  #latencies = [];

  /** Takes a message with so many samples. */
  samples(at, count) {
    this.#arrived.push([at, count]);
  }

  /** Takes the age in ms of a sample as it is drawn for the first time. */
  drawn(age) {
    this.#latencies.push(Math.max(0, age));
  }

  /** Samples a second at a time in ms, in words. */
  perSecond(now) {
    this.#arrived = this.#arrived.filter(([at]) => at > now - SPAN);
    const [first, last] = [this.#arrived[0], this.#arrived.at(-1)];
    const samples = this.#arrived.slice(1).reduce((sum, [, count]) => sum + count, 0);
    return samples ? ((1000 * samples) / (last[0] - first[0])).toFixed(0) : "0";
  }

  /** Median and longest of the latencies since the last call, in words; null without any. */
  latency() {
    if (this.#latencies.length === 0) {
      return null;
    }
    const sorted = this.#latencies.toSorted((a, b) => a - b);
    this.#latencies = [];
    const at = (share) => sorted[Math.floor(share * (sorted.length - 1))].toFixed(0);
    return t("rate.now", { median: at(0.5), most: at(1) });
  }
}
