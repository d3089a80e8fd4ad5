// Panel that leads the wearer through a calibration or a task: what to do now, how much of it, and what comes next.

import { find, write } from "./dom.js";
import { draw, words } from "./gestures.js";
import { classOf } from "./history.js";

/** Who leads, with the button `stop` that ends it; null if nobody does. */
let leader = null;

find("guide-stop").addEventListener("click", () => leader?.stop.click());

/** Shows a cue, how it is done, and the next one; nothing without a cue. */
export function lead(who, cue, hint = "", next = null) {
  if (cue || leader === who) {
    leader = cue ? who : null;
    find("guide").hidden = !cue;
  }
  if (cue) {
    find("guide").dataset.label = classOf(cue);
    draw(find("guide-hand"), cue);
    write(find("guide-task"), words(cue));
    write(find("guide-hint"), hint);
    draw(find("guide-next"), next);
    write(find("guide-then"), next ? words(next) : "");
  }
}

/** Shows how far it is: a number, words above it, and the share that is left. */
export function pace(count, words, share) {
  write(find("guide-count"), count);
  write(find("guide-left"), words);
  find("guide-bar").style.width = `${100 * Math.max(0, share)}%`;
}
