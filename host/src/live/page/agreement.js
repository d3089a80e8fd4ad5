// Agreement of labels with what was asked for: the recording's cue, or the session's.

import { RATE } from "./clock.js";
import { classOf } from "./history.js";

/** The label that a cue asks for: other movement is to raise none. */
const expected = (cue) => (classOf(cue) === "other" ? "relax" : cue);

/** Samples after a change of the cue in which no label is judged: nobody follows at once. */
const GRACE = RATE;
const STEP = RATE / 20;

export class Agreement {
  /** [as asked, all] of the labels in gestures, and in rest. */
  gestures = [0, 0];
  rest = [0, 0];

  clear() {
    this.gestures = [0, 0];
    this.rest = [0, 0];
  }

  /** Judges a label and counts it. */
  take(history, { instant, label }) {
    const { state, cue } = judge(history, instant, label);
    if (state === "right" || state === "wrong") {
      const counts = expected(cue) === "relax" ? this.rest : this.gestures;
      counts[0] += state === "right" ? 1 : 0;
      counts[1] += 1;
    }
    return { state, cue };
  }
}

/** Whether a label is what was asked for at its sample: `right`, `wrong`, `soon` just after a change, `none` without a cue. */
export function judge(history, sample, label) {
  const cue = history.truthAt(sample) ?? null;
  if (cue === null || label === null) {
    return { state: "none", cue };
  }
  for (let back = STEP; back <= GRACE; back += STEP) {
    if (history.truthAt(Math.max(0, sample - back)) !== cue) {
      return { state: "soon", cue };
    }
  }
  return { state: label === expected(cue) ? "right" : "wrong", cue };
}

/** A share of counted labels in per cent; null of none. */
export function percent([right, all]) {
  return all ? Math.round((100 * right) / all) : null;
}
