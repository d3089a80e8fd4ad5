// Label and cue side by side, and whether they agree: in the picture, in words, and for a screen reader.

import { judge, percent } from "./agreement.js";

const CAUSES = {
  boot: "started; needs 3 s of samples",
  watchdog: "the watchdog restarted the board; needs 3 s of samples",
  stack: "a stack overflow restarted the board; needs 3 s of samples",
  "model-refused": "the board cannot run its model: flash one",
  disconnected: "the armband was disconnected",
  silence: "no sample for 200 ms",
  gap: "more than 5 samples in a row were lost; needs 3 s of samples",
  losses: "more than 10 % of the last 3 s were lost",
  stalled: "the board was too slow; needs 3 s of samples",
  installation: "a new model is being installed",
};

/** Sign and word of each state of the agreement. */
const SIGNS = { right: ["✓", "as asked"], wrong: ["✗", "not as asked"], soon: ["…", "changing"] };

const find = (id) => document.getElementById(id);

function write(node, text) {
  if (node.textContent !== text) {
    node.textContent = text;
  }
}

/** Why there is no label, in words. */
export const causeText = (cause) => CAUSES[cause] ?? cause;

export class Now {
  #label = find("label");
  #asked = find("truth");
  #agrees = find("agrees");
  #valid = find("valid");
  #shown = "";

  /** Shows the label of a position in samples: { label, valid, cause }, or null with the reason `none`. */
  show(history, position, entry, none) {
    const label = entry?.valid ? entry.label : null;
    const { state, cue } = history.hasTruth ? judge(history, Math.floor(position), label) : { state: "none", cue: null };
    const shown = JSON.stringify([entry?.label, entry?.valid, entry?.cause, state, cue, none, history.hasTruth]);
    if (shown === this.#shown) {
      return;
    }
    this.#shown = shown;
    this.#label.dataset.label = entry?.label ?? "relax";
    this.#label.classList.toggle("safe", label === null);
    write(this.#label, entry?.label ?? "–");
    // Between two sessions nothing is asked for.
    const isAsked = history.hasTruth && (cue !== null || history.cues.length === 0);
    this.#asked.hidden = !isAsked;
    this.#asked.lastChild.dataset.label = cue ?? "relax";
    write(this.#asked.lastChild, cue ?? "–");
    const [sign, word] = SIGNS[state] ?? ["", ""];
    this.#agrees.hidden = !isAsked;
    this.#agrees.dataset.state = state;
    write(this.#agrees.firstElementChild, sign);
    write(this.#agrees.lastElementChild, word);
    this.#valid.dataset.valid = entry === null ? "unknown" : entry.valid ? "yes" : "no";
    write(this.#valid, entry === null ? none : entry.valid ? "label in use" : `label not in use: ${causeText(entry.cause)}`);
  }

  /** Shows the shares of the labels that are as asked; `data-gestures` is the number of those in gestures. */
  share({ gestures, rest, other }) {
    const groups = [[gestures, "gestures"], [rest, "rest"], [other, "other movement"]];
    const parts = groups.filter(([[, all]]) => all > 0).map(([counts, name]) => `${percent(counts)} % in ${name}`);
    find("share").hidden = parts.length === 0;
    find("share").dataset.gestures = gestures[1];
    write(find("share").lastElementChild, parts.join(", "));
  }

  /** Says the label to a screen reader; to be called rarely, as each change is read out. */
  speak() {
    const asked = this.#asked.hidden ? "" : `asked: ${this.#asked.lastChild.textContent}; `;
    const word = this.#agrees.lastElementChild.textContent;
    const label = this.#label.classList.contains("safe") ? this.#valid.textContent : this.#label.textContent;
    write(find("spoken"), `${asked}label: ${label}${word ? `, ${word}` : ""}`);
  }
}
