// Rows of blocks below the traces: what was asked for, the labels, and where they differ.

import { RATE } from "./clock.js";
import { judge } from "./agreement.js";
import { classOf, lastUpTo } from "./history.js";
import { named } from "./texts.js";

/** Height and distance of the strokes under a label that is not as asked, in px, and the step in which it is looked for. */
const HATCHED = 6;
const STEP = RATE / 20;

// One block of a label, with its name if there is room.
function block(view, from, to, name, top, height, safe) {
  const { pen, colours } = view;
  const [left, right] = [Math.max(view.left, view.x(from)), Math.min(view.width, view.x(to))];
  if (right <= left) {
    return;
  }
  if (safe) {
    pen.strokeStyle = colours.line;
    pen.strokeRect(left + 0.5, top + 0.5, right - left - 1, height - 1);
  } else {
    // Rest is most of the time: quiet, so that gestures stand out.
    pen.fillStyle = name === "relax" ? colours.line : colours[classOf(name)];
    pen.fillRect(left, top, right - left, height);
  }
  const text = safe ? name : named("class", name);
  if (pen.measureText(text).width + 10 < right - left) {
    const onRest = name === "relax" ? colours.ink : colours["on-class"];
    pen.fillStyle = safe ? colours.quiet : onRest;
    pen.textAlign = "left";
    pen.fillText(text, left + 5, top + height / 2 + 0.5);
  }
}

/** What was asked for. */
export function cues(view, top, height) {
  const { history } = view;
  const end = Math.min(history.end, Math.floor(view.to));
  let from = Math.max(history.first, Math.ceil(view.from));
  while (from < end) {
    const name = history.truthAt(from);
    let to = from + 1;
    while (to < end && history.truthAt(to) === name) {
      to += 1;
    }
    if (name) {
      block(view, from, to, name, top, height, false);
    }
    from = to;
  }
}

/** The labels, each for `hold` samples at least; `none` gives the text of a stretch without one. */
export function labels(view, top, height, hold, none) {
  const { labels: all } = view.history;
  let at = Math.max(0, lastUpTo(all, "from", view.from));
  while (at < all.length && all[at].from < view.to) {
    const { from, label, valid, cause } = all[at];
    let next = at + 1;
    while (next < all.length && all[next].label === label && all[next].valid === valid) {
      next += 1;
    }
    // The newest label is for the hold alone; a state lasts.
    const open = valid ? Math.min(view.to, all[next - 1].from + hold) : view.to;
    const to = next < all.length ? all[next].from : open;
    block(view, from, to, valid ? label : none(cause), top, height, !valid);
    if (valid && view.history.hasTruth) {
      differences(view, from, to, label, top + height);
    }
    at = next;
  }
}

// Hatched, so that no colour has to be told from another.
function differences(view, from, to, label, top) {
  const { pen, history } = view;
  pen.strokeStyle = view.colours.bad;
  pen.lineWidth = 2;
  pen.beginPath();
  const first = Math.max(from, history.first, Math.floor(view.from));
  const end = Math.min(to, view.to, history.end);
  for (let sample = Math.ceil(first / STEP) * STEP; sample < end; sample += STEP) {
    if (judge(history, sample, label).state === "wrong") {
      const right = view.x(Math.min(end, sample + STEP));
      for (let x = Math.ceil(view.x(sample) / HATCHED) * HATCHED; x < right; x += HATCHED) {
        pen.moveTo(x, top + HATCHED);
        pen.lineTo(x + HATCHED / 2, top + 1);
      }
    }
  }
  pen.stroke();
}
