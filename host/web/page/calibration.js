// Calibration: leads the wearer through half a minute, says what it gained, takes it back, and saves the model.

import { find, write } from "./dom.js";
import { lead, pace } from "./guide.js";
import { named, t } from "./texts.js";

export class Calibration {
  stop = find("calibrate");
  #message = null;
  /** Time of this page when the cue began, in ms. */
  #began = 0;

  constructor(say) {
    const ask = (wish) => say({ do: "calibrate", wish });
    find("calibrate").addEventListener("click", () => ask(this.isRunning ? "cancel" : "begin"));
    find("forget").addEventListener("click", () => ask("forget"));
    find("save-model").addEventListener("click", () => ask("save"));
  }

  /** Whether the wearer is asked for something. */
  get isRunning() {
    return ["teaching", "judging"].includes(this.#message?.state);
  }

  /** Takes a message; null where there is no stream any more. */
  take(message) {
    this.#message = message;
    this.#began = performance.now();
    const { state, cue, next, before, learnt, in_use: inUse } = message ?? { state: "idle", cue: null, in_use: false };
    const { isRunning } = this;
    lead(this, isRunning ? cue : null, t(cue === "relax" ? "how.relax" : "how.gesture"), next);
    find("calibrate").setAttribute("aria-pressed", String(isRunning));
    write(find("calibrate").firstElementChild, t(isRunning ? "calibrate.stop" : "calibrate"));
    const percent = (thousandths) => Math.round(thousandths / 10);
    const numbers = learnt === null || learnt === undefined ? {} : { before: percent(before), after: percent(learnt) };
    const result = { cue: cue ? named("class", cue) : "", ...numbers };
    write(find("calibrated"), state === "idle" ? t(inUse ? "calibrated.kept" : "calibrated.idle") : t(`calibrated.${state}`, result));
    find("forget").hidden = !inUse || isRunning;
    // A board keeps it itself.
    find("save-model").hidden = find("forget").hidden || document.body.dataset.kind === "port";
  }

  /** The countdown. */
  frame() {
    if (!this.isRunning) {
      return;
    }
    const { seconds, left, state } = this.#message;
    const passed = (performance.now() - this.#began) / 1000;
    const count = seconds === null ? "" : String(Math.max(0, Math.ceil(seconds - passed)));
    const round = t(`calibrated.${state}`);
    const words = left === null ? round : t("calibrate.left", { round, n: Math.max(0, Math.ceil(left - passed)) });
    pace(count, words, seconds === null ? 0 : 1 - passed / seconds);
  }
}
