// Box and blocks against time: leads through it, counts down, and says the score.

import { find, write } from "./dom.js";
import { lead, pace } from "./guide.js";
import { t } from "./texts.js";

export const SECONDS = 60;

export class Blocks {
  stop = find("play");
  #message = null;
  /** Time of this page when the message came, in ms. */
  #came = 0;

  constructor(say) {
    find("play").addEventListener("click", () => say({ do: "blocks", begin: !this.#cue }));
  }

  get #cue() {
    return this.#message?.cue ?? null;
  }

  /** Takes a message; null where there is no stream any more. */
  take(message) {
    this.#message = message;
    this.#came = performance.now();
    const cue = this.#cue;
    lead(this, cue, t(message?.left ? "blocks.hint" : "blocks.ready"), cue === "close" ? "open" : "close");
    find("play").setAttribute("aria-pressed", String(cue !== null));
    write(find("play").firstElementChild, t(cue ? "blocks.stop" : "blocks.play"));
    write(find("played"), t(`blocks.${message?.state ?? "idle"}`, { n: message?.moved }));
  }

  /** The countdown. */
  frame() {
    if (this.#cue) {
      const { left, moved } = this.#message;
      const now = left === null ? SECONDS : Math.max(0, left - (performance.now() - this.#came) / 1000);
      pace(t("blocks.moved", { n: moved }), t("blocks.left", { n: Math.ceil(now) }), now / SECONDS);
    }
  }
}
