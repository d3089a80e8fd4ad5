// What to do while there is nothing to see: a heading, and steps.

import { find, made } from "./dom.js";
import { said, t } from "./texts.js";

/** Time without samples after which an armband is taken to be asleep, in ms. */
const QUIET = 3000;

const ASLEEP = [t("asleep.1"), t("asleep.2"), t("asleep.3")];
const UNBOUND = [t("unbound.1"), t("unbound.2")];

export class Empty {
  #known = {};
  #since = performance.now();
  #gone = null;
  #shown = "";

  /** Takes any message; most are about something else. */
  take(message) {
    if (message.type === "samples") {
      this.#since = performance.now();
    } else if (message.type === "hello") {
      this.#known = {};
      this.#gone = null;
      this.#since = performance.now();
    } else if (["source", "board", "binding"].includes(message.type)) {
      this.#known[message.type] = message;
      this.#since = message.type === "source" ? performance.now() : this.#since;
    }
  }

  /** The program has ended, or does not answer: a title and a step. */
  gone(advice) {
    this.#gone = advice;
  }

  /** Shows what is missing now; to be called every second. */
  show() {
    const [title, steps, demo] = this.#missing() ?? ["", [], false];
    const text = JSON.stringify([title, steps]);
    if (text === this.#shown) {
      return;
    }
    this.#shown = text;
    find("empty").hidden = title === "";
    find("empty-title").textContent = title;
    find("empty-steps").replaceChildren(...steps.map((step) => made("li", step)));
    // A page with the program inside has a button for it.
    find("empty-demo").hidden = !demo || !find("sources").hidden;
  }

  #missing() {
    const { source, board, binding } = this.#known;
    if (this.#gone) {
      return [this.#gone[0], this.#gone.slice(1), false];
    }
    if (!source) {
      return null;
    }
    const title = t(source.kind === "port" ? "empty.port" : "empty.armband", { detail: said(source.detail) });
    if (!source.connected) {
      return source.steps.length ? [title, source.steps.map(said), true] : null;
    }
    if (source.kind !== "port" || performance.now() - this.#since < QUIET) {
      return null;
    }
    if (binding?.state === "nobody") {
      return [t("empty.nobody"), UNBOUND, true];
    }
    const first = board?.armband
      ? t("empty.sends", { address: board.armband })
      : t("empty.looks", { address: binding?.armband ?? "" }).trim();
    return [first, ASLEEP, true];
  }
}
