// The picture: eight traces, scores, the recording's labels, the emitted ones, look-ahead and hold, all over one time.

import { CHANNELS, lastUpTo } from "./history.js";
import { RATE } from "./clock.js";
import { causeText } from "./now.js";
import { cues, labels } from "./rows.js";
import { t } from "./texts.js";
import { axis, grid, marks, ruler } from "./time.js";

const GUTTER = 64;
const HEIGHTS = { scores: 84, label: 22, ruler: 40, axis: 18, gap: 8 };
/** Height below which the traces need the room of the scores. */
const ROOM = 340;
// Of a lane: strong samples may reach into the next ones.
const REACH = 0.85;
const SCALES = [16, 32, 64, 128];

export class Traces {
  #canvas;
  #context;
  #colours = {};
  #scale = 64;
  #weak = 0;
  /** Whether size or colours have changed since the picture was drawn. */
  isStale = true;
  /** Seconds over the width. */
  seconds = 5;
  /** Whether scores are drawn; without them the traces have their room. */
  scores = true;
  /** { classes, other, look_ahead, hold }; null without a model on the PC. */
  model = null;

  constructor(canvas) {
    this.#canvas = canvas;
    this.#context = canvas.getContext("2d");
    this.colours();
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.colours());
    new ResizeObserver(() => this.#resize()).observe(canvas);
    this.#resize();
  }

  /** Reads the colours of the style sheet. */
  colours() {
    const style = getComputedStyle(document.documentElement);
    const names = ["card", "ink", "quiet", "line", "trace", "relax", "open", "close", "wave-in", "wave-out", "pinch", "other",
      "on-class", "shade", "bad", "focus"];
    for (const name of names) {
      this.#colours[name] = style.getPropertyValue(`--${name}`).trim();
    }
    this.isStale = true;
    this.font = `12px ${getComputedStyle(document.body).fontFamily}`;
  }

  #resize() {
    this.isStale = true;
    const ratio = devicePixelRatio || 1;
    const { clientWidth, clientHeight } = this.#canvas;
    this.#canvas.width = Math.round(clientWidth * ratio);
    this.#canvas.height = Math.round(clientHeight * ratio);
    this.#context.setTransform(ratio, 0, 0, ratio, 0, 0);
    this.seconds = clientWidth < 620 ? 3 : 5;
  }

  /** Draws what was seen up to a position, in samples; `newest` is the label whose look-ahead and hold are shown, or null. */
  draw(history, position, newest) {
    this.isStale = false;
    const pen = this.#context;
    const { clientWidth: width, clientHeight: height } = this.#canvas;
    pen.clearRect(0, 0, width, height);
    pen.font = this.font;
    pen.textBaseline = "middle";
    const span = this.seconds * RATE;
    const view = {
      history, pen, colours: this.#colours, width, left: GUTTER, from: position - span, to: position,
      x: (sample) => GUTTER + ((sample - position + span) / span) * (width - GUTTER - 1),
    };
    const { scores, label, ruler: rule, axis: bottom, gap } = HEIGHTS;
    const withScores = this.model !== null && this.scores && height > ROOM;
    const rest = (withScores ? scores + gap : 0) + (history.hasTruth ? label + gap : 0) + label + gap + rule + bottom + gap;
    const lane = (height - rest) / CHANNELS;
    grid(view, height - bottom);
    this.#adapt(view);
    for (let channel = 0; channel < CHANNELS; channel += 1) {
      this.#trace(view, channel, channel * lane, lane);
    }
    let top = CHANNELS * lane + gap;
    if (withScores) {
      this.#scores(view, top, scores);
      top += scores + gap;
    }
    if (history.hasTruth) {
      this.#caption(t("row.asked"), top + label / 2);
      cues(view, top, label);
      top += label + gap;
    }
    this.#caption(t("row.label"), top + label / 2);
    labels(view, top, label, this.hold, (cause) => t("no.label", { cause: causeText(cause) }));
    ruler(view, newest, this.hold, top + label, rule);
    marks(view, height - bottom);
    axis(view, height - bottom, bottom);
  }

  #caption(text, y) {
    const pen = this.#context;
    pen.fillStyle = this.#colours.quiet;
    pen.textAlign = "right";
    pen.fillText(text, GUTTER - 8, y);
  }

  // The strongest sample in view decides; a weaker view changes the scale after a while alone, or it would flicker.
  #adapt(view) {
    let most = 0;
    for (let sample = Math.max(view.history.first, Math.ceil(view.from)); sample < Math.min(view.history.end, view.to); sample += 2) {
      for (let channel = 0; channel < CHANNELS; channel += 1) {
        most = Math.max(most, Math.abs(view.history.value(sample, channel)));
      }
    }
    const needed = SCALES.find((scale) => scale >= most) ?? 128;
    if (needed >= this.#scale) {
      this.#weak = 0;
      this.#scale = needed;
    } else {
      this.#weak += 1;
      if (this.#weak > 120) {
        this.#scale = needed;
        this.#weak = 0;
      }
    }
  }

  #trace(view, channel, top, height) {
    const pen = this.#context;
    const middle = top + height / 2;
    const gain = (REACH * height) / this.#scale;
    // Low lanes have no room for each number, nor for the scale.
    if (height > 12 || channel === 0 || channel === CHANNELS - 1) {
      this.#caption(String(channel + 1), middle);
    }
    if (channel === 0 && height > 28) {
      this.#caption(`±${this.#scale}`, middle + 15);
    }
    pen.strokeStyle = this.#colours.trace;
    // Thin and without round joins: 8000 lines a frame, by the processor where there is no graphics card.
    pen.lineWidth = 1;
    pen.lineJoin = "bevel";
    pen.beginPath();
    let drawing = false;
    const first = Math.max(view.history.first, Math.ceil(view.from));
    const end = Math.min(view.history.end ?? 0, Math.floor(view.to) + 1);
    for (let sample = first; sample < end; sample += 1) {
      if (!view.history.has(sample)) {
        drawing = false;
        continue;
      }
      const [x, y] = [view.x(sample), middle - gain * view.history.value(sample, channel)];
      if (drawing) {
        pen.lineTo(x, y);
      } else {
        pen.moveTo(x, y);
        drawing = true;
      }
    }
    pen.stroke();
  }

  #scores(view, top, height) {
    const pen = this.#context;
    const { classes, other } = this.model;
    const names = other ? [...classes, "other"] : classes;
    this.#caption("1", top + 5);
    this.#caption(t("row.scores"), top + height / 2);
    this.#caption("0", top + height - 5);
    pen.strokeStyle = this.#colours.line;
    pen.strokeRect(view.left + 0.5, Math.round(top) + 0.5, view.width - view.left - 1, height);
    const start = Math.max(0, lastUpTo(view.history.scores, "instant", view.from) - 1);
    names.forEach((name, place) => {
      pen.strokeStyle = this.#colours[name];
      pen.lineWidth = 2;
      pen.setLineDash(name === "other" ? [6, 3] : []);
      pen.save();
      pen.beginPath();
      pen.rect(view.left, top, view.width - view.left, height);
      pen.clip();
      pen.beginPath();
      let last = -Infinity;
      for (let at = start; at < view.history.scores.length; at += 1) {
        const { instant, scores } = view.history.scores[at];
        if (instant > view.to) {
          break;
        }
        const [x, y] = [view.x(instant), top + 3 + (1 - scores[place]) * (height - 6)];
        if (instant - last > RATE / 4) {
          pen.moveTo(x, y);
        } else {
          pen.lineTo(x, y);
        }
        last = instant;
      }
      pen.stroke();
      pen.restore();
    });
    pen.setLineDash([]);
  }

  /** Samples from one label to the next. */
  get hold() {
    return this.model?.hold ?? 20;
  }
}
