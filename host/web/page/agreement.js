// Agreement of labels with what was asked for: the recording's cue, or the session's.

import { RATE } from "./clock.js";

/** Samples after a change of the cue in which no label is counted, and none is wrong: nobody follows at once. */
const GRACE = RATE;
/** Samples from the moment that a label is for to its end, at most: look-ahead and hold. */
export const LATE = 70;
const STEP = RATE / 20;
/** Labels in gestures that say something of all: 3 s of them. */
export const ENOUGH = 30;

export class Agreement {
  constructor() {
    this.clear();
  }

  clear() {
    /** [as asked, all] of the labels in gestures, in rest and in other movement. */
    this.gestures = [0, 0];
    this.rest = [0, 0];
    this.other = [0, 0];
  }

  /** Judges a label and counts it. Returns whether it is right; null in rest, and where it is not judged. */
  take(history, { instant, label }) {
    const { state, cue, isNew } = judge(history, instant, label);
    if (state === "none" || isNew) {
      return null;
    }
    const isRight = state === "right";
    const counts = cue === "relax" ? this.rest : history.classes.includes(cue) ? this.gestures : this.other;
    counts[0] += isRight ? 1 : 0;
    counts[1] += 1;
    return counts === this.gestures ? isRight : null;
  }
}

/** Whether a label is what was asked for at its sample: `right`, `wrong`, `soon` just after a change, `none` without a cue;
 *  `means` for a class of the model, `isNew` in the first second after a change. `late` are samples from its moment to this one. */
export function judge(history, sample, label, late = 0) {
  const cue = history.truthAt(sample) ?? null;
  if (cue === null || label === null) {
    return { state: "none", cue, means: false };
  }
  // A movement that is none of the model's classes means nothing, as rest does.
  const means = history.classes.includes(cue);
  const isRight = label === (means ? cue : "relax");
  for (let back = STEP; back <= GRACE + late; back += STEP) {
    if (history.truthAt(Math.max(0, sample - back)) !== cue) {
      return { state: isRight ? "right" : "soon", cue, means, isNew: true };
    }
  }
  return { state: isRight ? "right" : "wrong", cue, means };
}

/** A share of counted labels in per cent; null of none. */
export function percent([right, all]) {
  return all ? Math.round((100 * right) / all) : null;
}
