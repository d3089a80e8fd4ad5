// Label and cue side by side, and whether they agree: in the picture, in words, and for a screen reader.

import { ENOUGH, LATE, judge, percent } from "./agreement.js";
import { find, write } from "./dom.js";
import { named, t } from "./texts.js";

/** Sign and word of each state of the agreement. */
const SIGNS = { right: ["✓", t("as.asked")], wrong: ["✗", t("not.as.asked")], soon: ["…", t("changing")], ignored: ["✓", t("ignored")] };

/** Share in per cent below which there is advice. */
const LOW = 50;

/** Causes that pass by themselves, or that somebody asked for. */
const PASSING = ["boot", "installation", "locked"];

/** Why there is no label, in words. */
export const causeText = (cause) => named("cause", cause);

export class Now {
  #label = find("label");
  #asked = find("truth");
  #agrees = find("agrees");
  #valid = find("valid");
  #shown = "";
  /** The label that is shown; null without one. */
  label = null;
  /** What was asked for, as `judge` says it. */
  judged = { state: "none", cue: null, means: false };

  /** Shows the label of a position in samples: { label, valid, cause }, or null with the reason `none`; what was asked for, unless the stream is lost; and why the label is rest, if other movement is the reason. */
  show(history, position, entry, none, isThere, isOther) {
    const label = entry?.valid ? entry.label : null;
    this.label = label;
    this.judged = history.hasTruth ? judge(history, Math.floor(position), label, LATE) : { state: "none", cue: null, means: false };
    const { state, cue, means } = this.judged;
    const shown = JSON.stringify([entry?.label, entry?.valid, entry?.cause, state, cue, means, none, history.hasTruth, isThere, isOther]);
    if (shown === this.#shown) {
      return;
    }
    this.#shown = shown;
    this.#label.dataset.label = label ?? "relax";
    this.#label.classList.toggle("safe", label === null);
    write(this.#label, label ? named("class", label) : "–");
    // Between two sessions nothing is asked for.
    const isAsked = isThere && history.hasTruth && (cue !== null || history.cues.length === 0);
    this.#asked.hidden = !isAsked;
    this.#asked.lastChild.dataset.label = cue ?? "relax";
    write(this.#asked.lastChild, cue ? named("class", cue) : "–");
    const [sign, word] = SIGNS[state === "right" && !means ? "ignored" : state] ?? ["", ""];
    this.#agrees.hidden = !isAsked;
    this.#agrees.dataset.state = state;
    write(this.#agrees.firstElementChild, sign);
    write(this.#agrees.lastElementChild, word);
    this.#valid.dataset.valid = entry === null ? "unknown" : entry.valid ? "yes" : PASSING.includes(entry.cause) ? "passing" : "no";
    write(this.#valid, entry === null ? none : entry.valid ? t(isOther && label === "relax" ? "in.use.other" : "in.use") : t("no.label", { cause: causeText(entry.cause) }));
  }

  /** Shows the shares of the labels that are as asked, and advice where those in gestures are few; `data-gestures` is their number. */
  share({ gestures, rest, other }) {
    const groups = [[gestures, "share.gestures"], [rest, "share.rest"], [other, "share.other"]];
    const parts = groups.filter(([[, all]]) => all > 0).map(([counts, name]) => t(name, { percent: percent(counts) }));
    find("share").hidden = parts.length === 0;
    find("share").dataset.gestures = gestures[1];
    // Labels that are worse since an alignment have advice of their own.
    find("low").hidden = gestures[1] < ENOUGH || percent(gestures) >= LOW || find("worse").textContent !== "";
    write(find("share").lastElementChild, parts.join(", "));
  }

  /** Says the label to a screen reader; to be called rarely, as each change is read out. */
  speak() {
    const word = this.#agrees.lastElementChild.textContent;
    if (this.#label.classList.contains("safe")) {
      write(find("spoken"), this.#valid.textContent);
      return;
    }
    const label = word ? t("spoken.judged", { label: this.#label.textContent, word }) : this.#label.textContent;
    const asked = this.#asked.lastChild.textContent;
    write(find("spoken"), this.#asked.hidden ? t("spoken", { label }) : t("spoken.asked", { asked, label }));
  }
}
