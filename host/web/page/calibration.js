// Calibration: leads the wearer through half a minute, says what it gained, takes it back, and saves the model.

import { find, write } from "./dom.js";
import { draw, words } from "./gestures.js";
import { classOf } from "./history.js";
import { named, t } from "./texts.js";

export class Calibration {
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
    find("calibrating").hidden = !isRunning;
    find("calibrate").setAttribute("aria-pressed", String(isRunning));
    write(find("calibrate").firstElementChild, t(isRunning ? "calibrate.stop" : "calibrate"));
    if (isRunning) {
      find("calibrating").dataset.label = classOf(cue);
      draw(find("calibrating-hand"), cue);
      write(find("calibrating-task"), words(cue));
      write(find("calibrating-hint"), t(cue === "relax" ? "how.relax" : "how.gesture"));
      draw(find("calibrating-next"), next);
      write(find("calibrating-then"), next ? words(next) : "");
    }
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
    write(find("calibrating-count"), seconds === null ? "" : String(Math.max(0, Math.ceil(seconds - passed))));
    find("calibrating-bar").style.width = seconds === null ? "0" : `${Math.max(0, 100 - (100 * passed) / seconds)}%`;
    const round = t(`calibrated.${state}`);
    write(find("calibrating-left"), left === null ? round : t("calibrate.left", { round, n: Math.max(0, Math.ceil(left - passed)) }));
  }
}
