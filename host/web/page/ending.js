// Question before a session ends: the session waits meanwhile, and goes on if the answer is no.

import { find } from "./dom.js";
import { t } from "./texts.js";

export class Ending {
  #say;
  #dialog = find("ending");
  /** Whether the session was running when the question was asked. */
  #ran = false;

  constructor(say) {
    this.#say = say;
    find("end-now").addEventListener("click", () => this.#answer(true));
    find("go-on").addEventListener("click", () => this.#answer(false));
    // By the browser's own means, such as a gesture.
    this.#dialog.addEventListener("cancel", (event) => {
      event.preventDefault();
      this.#answer(false);
    });
  }

  get isAsking() {
    return this.#dialog.open;
  }

  /** Asks, and has a session that runs wait. */
  ask({ phase, round, rounds, done, trials, free }) {
    this.#ran = phase === "ready" || phase === "cued";
    if (this.#ran) {
      this.#say({ do: "session", wish: "hold" });
    }
    find("ending-text").textContent = free ? t("ending.free") : t("ending.some", { round, rounds, done, trials });
    this.#dialog.showModal();
  }

  /** Takes a key while the question is asked. */
  key(name) {
    const answer = { e: true, Escape: false }[name];
    if (answer !== undefined) {
      this.#answer(answer);
    }
    return answer !== undefined;
  }

  /** The session has ended meanwhile. */
  close() {
    this.#dialog.close();
  }

  #answer(ends) {
    this.#dialog.close();
    if (ends) {
      this.#say({ do: "session", wish: "finish" });
    } else if (this.#ran) {
      this.#say({ do: "session", wish: "begin" });
    }
  }
}
