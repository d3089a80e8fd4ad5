// History of the stream: samples, labels, scores and marks of the last minutes, by the number of the sample.

import { RATE } from "./clock.js";

export const CHANNELS = 8;
const MINUTES = 10;
const CAPACITY = MINUTES * 60 * RATE;
export const CLASSES = ["relax", "open", "close", "wave-in", "wave-out", "pinch"];

/** The class of a gesture, as colours and keys have it: movement that is none of the intents is one class, `other`. */
export const classOf = (name) => (CLASSES.includes(name) ? name : "other");

/** Number of a gesture in a recording: -1 without one, -2 for other movement. */
const number = (name) => (name === null || CLASSES.includes(name) ? CLASSES.indexOf(name) : -2);

export class SampleHistory {
  emg = new Int8Array(CAPACITY * CHANNELS);
  truth = new Array(CAPACITY).fill(null);
  /** How the armband sits, as the board is aligned: its turn, and 8 more if it is mirrored. */
  placed = 0;
  #placements = new Uint8Array(CAPACITY);
  #present = new Uint8Array(CAPACITY);
  /** After the newest sample; null before the first. */
  end = null;
  first = 0;
  hasTruth = false;
  /** Names of the model's classes; all of them until a model says which. */
  classes = CLASSES;
  /** { from, label, valid, cause }, in order: each until the next. */
  labels = [];
  /** { instant, scores }, in order. */
  scores = [];
  /** { from, name }, in order: what a session asked for, each until the next. */
  cues = [];
  /** { sample, text }, in order. */
  marks = [];

  /** Takes consecutive samples. */
  samples(first, emg, truth) {
    if (this.end !== null && (first < this.end - RATE || first - this.end > CAPACITY / 2)) {
      this.clear();
    }
    if (this.end === null) {
      this.first = this.end = first;
    }
    for (; this.end < first; this.end += 1) {
      this.#present[this.end % CAPACITY] = 0;
    }
    emg.forEach((sample, place) => {
      const slot = (first + place) % CAPACITY;
      this.#present[slot] = 1;
      this.emg.set(sample, slot * CHANNELS);
      this.truth[slot] = truth ? truth[place] : null;
      this.#placements[slot] = this.placed;
    });
    this.hasTruth ||= Boolean(truth);
    this.end = Math.max(this.end, first + emg.length);
    this.first = Math.max(this.first, this.end - CAPACITY);
    this.#forget();
  }

  /** [turn, mirrored] of a sample. */
  placement(sample) {
    const placed = this.#placements[sample % CAPACITY];
    return [placed & 7, placed >> 3];
  }

  /** Takes a label, or a change of state. */
  report(report) {
    const from = report.is_label ? report.instant : report.emitted;
    while (this.labels.length && this.labels.at(-1).from > from) {
      this.labels.pop();
    }
    const { label, valid, cause } = report;
    this.labels.push({ from, label, valid, cause });
  }

  /** A session asks for something from a sample on, or for nothing. */
  cue(from, name) {
    while (this.cues.length && this.cues.at(-1).from >= from) {
      this.cues.pop();
    }
    this.cues.push({ from, name });
    this.hasTruth = true;
  }

  has(sample) {
    return sample >= this.first && sample < this.end && this.#present[sample % CAPACITY] === 1;
  }

  value(sample, channel) {
    return this.emg[(sample % CAPACITY) * CHANNELS + channel];
  }

  truthAt(sample) {
    if (this.cues.length) {
      return this.cues[lastUpTo(this.cues, "from", sample)]?.name ?? null;
    }
    return this.truth[sample % CAPACITY];
  }

  /** Label of a sample, or the state without one; null if it is not known. */
  labelAt(sample) {
    return this.labels[lastUpTo(this.labels, "from", sample)] ?? null;
  }

  /** Whether the last score, of other movement, is the highest at a sample. */
  isOther(sample) {
    const { scores = [] } = this.scores[lastUpTo(this.scores, "instant", sample)] ?? {};
    return scores.length > 0 && Math.max(...scores) === scores.at(-1);
  }

  /** The newest samples without a gap: [first, end]. */
  stretch() {
    let first = this.end ?? 0;
    while (first > this.first && this.has(first - 1)) {
      first -= 1;
    }
    return [first, this.end ?? 0];
  }

  clear() {
    this.#present.fill(0);
    this.end = null;
    this.first = 0;
    this.labels = [];
    this.scores = [];
    // What is asked for goes on, whatever became of the stream.
    this.cues = this.cues.slice(-1);
    this.hasTruth = this.cues.length > 0;
    this.marks = [];
  }

  #forget() {
    // By halves: moving a list costs as much as it is long.
    if (this.scores.length > MINUTES * 60 * 40) {
      this.scores = this.scores.filter((one) => one.instant >= this.first);
      this.labels = this.labels.filter((one, at) => (this.labels[at + 1]?.from ?? Infinity) >= this.first);
      this.marks = this.marks.filter((one) => one.sample >= this.first);
    }
  }
}

/** The place in a list, ordered by `key`, of the last entry that is not after `value`; -1 if there is none. */
export function lastUpTo(list, key, value) {
  let [low, high] = [0, list.length];
  while (low < high) {
    const middle = (low + high) >> 1;
    if (list[middle][key] <= value) {
      low = middle + 1;
    } else {
      high = middle;
    }
  }
  return low - 1;
}

/**
 * Csv of a history in ReactEMG's layout, with further columns that its readers ignore, and its duration in seconds.
 * Label: -1 where the recording has none, and for every sample of a board; -2 for other movement.
 */
export function csv(history) {
  const channels = Array.from({ length: CHANNELS }, (_, channel) => `emg_${channel}`);
  const rows = [["gt", ...channels, "sample", "label", "valid", "turn", "mirrored", "mark"].join(",")];
  const [first, end] = history.stretch();
  let mark = history.marks.findIndex((one) => one.sample >= first);
  for (let sample = first; sample < end; sample += 1) {
    const values = channels.map((_, channel) => history.value(sample, channel));
    const label = history.labels[lastUpTo(history.labels, "from", sample)];
    const texts = [];
    while (mark >= 0 && history.marks[mark]?.sample <= sample) {
      texts.push(history.marks[mark].text.replace(/[",\r\n]/g, " "));
      mark += 1;
    }
    rows.push([
      number(history.truthAt(sample)),
      ...values,
      sample,
      label?.label ?? "",
      label ? Number(label.valid) : "",
      ...history.placement(sample),
      texts.join("; "),
    ].join(","));
  }
  return { text: `${rows.join("\n")}\n`, seconds: (end - first) / RATE };
}
