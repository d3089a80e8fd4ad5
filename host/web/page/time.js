// Time axis and lines across all lanes: seconds, marks, and the samples that the newest label waited for.

import { RATE } from "./clock.js";
import { t } from "./texts.js";

/** A line for each second. */
export function grid({ pen, colours, from, to, x }, bottom) {
  pen.strokeStyle = colours.line;
  pen.lineWidth = 1;
  pen.beginPath();
  for (let sample = Math.ceil(from / RATE) * RATE; sample <= to; sample += RATE) {
    const at = Math.round(x(sample)) + 0.5;
    pen.moveTo(at, 0);
    pen.lineTo(at, bottom);
  }
  pen.stroke();
}

/** The seconds since the stream began. */
export function axis({ pen, colours, from, to, x, left, width }, top, height) {
  pen.fillStyle = colours.quiet;
  pen.textAlign = "center";
  for (let sample = Math.ceil(from / RATE) * RATE; sample <= to; sample += RATE) {
    const at = x(sample);
    if (sample >= 0 && at > left + 8 && at < width - 14) {
      pen.fillText(t("seconds", { n: sample / RATE }), at, top + height / 2 + 2);
    }
  }
}

/** Dotted lines with their texts. */
export function marks({ pen, colours, history, from, to, x, width }, bottom) {
  pen.strokeStyle = pen.fillStyle = colours.ink;
  pen.lineWidth = 1;
  for (const { sample, text } of history.marks) {
    if (sample < from || sample > to) {
      continue;
    }
    const at = Math.round(x(sample)) + 0.5;
    pen.setLineDash([2, 3]);
    pen.beginPath();
    pen.moveTo(at, 0);
    pen.lineTo(at, bottom);
    pen.stroke();
    pen.setLineDash([]);
    const late = at > width - 180;
    pen.textAlign = late ? "right" : "left";
    pen.fillText(text, at + (late ? -5 : 5), 8);
  }
}

const inMs = (samples) => ({ ms: (samples * 1000) / RATE });

/** What the newest label waited for, and how long it is held, to scale. */
export function ruler({ pen, colours, from, to, x, width }, newest, hold, top, height) {
  if (!newest || newest.instant > to || newest.emitted < from) {
    return;
  }
  const bracket = (begin, end, text, y) => {
    const [left, right] = [x(begin), Math.min(x(end), width - 1)];
    pen.strokeStyle = colours.ink;
    pen.lineWidth = 1.2;
    pen.beginPath();
    pen.moveTo(left, y - 4);
    pen.lineTo(left, y + 4);
    pen.moveTo(left, y);
    pen.lineTo(right, y);
    pen.moveTo(right, y - 4);
    pen.lineTo(right, y + 4);
    pen.stroke();
    pen.fillStyle = colours.quiet;
    pen.textAlign = "right";
    pen.fillText(text, left - 6, y + 0.5);
  };
  const { instant, emitted } = newest;
  pen.fillStyle = colours.shade;
  pen.fillRect(x(instant), 0, Math.min(x(emitted), width) - x(instant), top + height);
  bracket(instant, emitted, t("waits", inMs(emitted - instant)), top + 16);
  bracket(instant, instant + hold, t("stays", inMs(hold)), top + 31);
}
