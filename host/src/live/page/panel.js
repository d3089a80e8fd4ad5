// Texts and numbers beside the traces. Only what has changed is written to the document.

import { percent } from "./agreement.js";

const CAUSES = {
  boot: "started; needs 3 s of samples",
  watchdog: "the watchdog restarted the board; needs 3 s of samples",
  stack: "a stack overflow restarted the board; needs 3 s of samples",
  "model-refused": "the board cannot run its model: flash one",
  disconnected: "the armband was disconnected",
  silence: "no sample for 200 ms",
  gap: "more than 5 samples in a row were lost; needs 3 s of samples",
  losses: "more than 10 % of the window was lost",
  stalled: "the board was too slow; needs 3 s of samples",
  installation: "a new model is being installed",
};

const ALIGNMENTS = {
  waiting: (found) => `waiting: rest, open the hand wide for a second, rest; ${found} of 2 seen`,
  aligned: () => "aligned",
  "in-force": () => "in force",
  "poor-distance": () => "not aligned: those were no openings of the hand; nothing changed",
  "poor-margin": () => "not aligned: two placements look alike; nothing changed",
  timeout: () => "not aligned: no two openings of the hand in 30 s; nothing changed",
  cancelled: () => "alignment ended; nothing changed",
  disconnected: () => "not aligned since the armband was connected",
  unavailable: () => "this model has no template, so it cannot be aligned",
  set: () => "set",
};

const find = (id) => document.getElementById(id);

function write(node, text) {
  if (node.textContent !== text) {
    node.textContent = text;
  }
}

export class Panel {
  #label = find("label");
  #valid = find("valid");
  #truth = find("truth");

  source(state, text) {
    const node = find("source");
    node.dataset.state = state;
    write(node.querySelector("span"), text);
  }

  report({ label, valid, cause, lost, bridged, resets, emitted, instant, is_label: isLabel }) {
    if (this.#label.dataset.label !== label || this.#label.textContent !== label) {
      this.#label.dataset.label = label;
      write(this.#label, label);
    }
    this.#label.classList.toggle("safe", !valid);
    this.#valid.dataset.valid = valid ? "yes" : "no";
    const text = valid ? "valid" : `not valid: ${CAUSES[cause] ?? cause}`;
    if (this.#valid.textContent !== text) {
      const strong = document.createElement("b");
      strong.textContent = valid ? "valid" : "not valid";
      this.#valid.replaceChildren(strong, text.slice(strong.textContent.length));
    }
    if (isLabel) {
      this.number("delay", `${(emitted - instant) * 5} ms`);
    }
    const plural = resets === 1 ? "" : "s";
    this.number("lost", lost ? `${lost}, ${bridged} bridged, ${resets} reset${plural}` : "0");
  }

  noLabel(text) {
    this.#label.dataset.label = "relax";
    this.#label.classList.add("safe");
    write(this.#label, "–");
    this.#valid.dataset.valid = "unknown";
    write(this.#valid, text);
  }

  truth(label) {
    this.#truth.hidden = label === undefined;
    write(this.#truth.querySelector("b"), label ?? "no label");
  }

  /** Shares of the labels that are as asked, in per cent; `data-gestures` is the number of those in gestures. */
  share(agreement) {
    const [gestures, rest] = [percent(agreement.gestures), percent(agreement.rest)];
    const parts = [gestures === null ? "" : `${gestures} % in gestures`, rest === null ? "" : `${rest} % in rest`].filter(Boolean);
    find("share").hidden = parts.length === 0;
    find("share").dataset.gestures = agreement.gestures[1];
    write(find("share"), `labels as asked: ${parts.join(", ")}`);
  }

  number(id, text) {
    write(find(id), text);
  }

  legend(model) {
    const names = model ? [...model.classes, ...(model.other ? ["other"] : [])] : [];
    const entries = names.map((name) => {
      const entry = document.createElement("span");
      entry.className = name;
      entry.append(document.createElement("i"), name === "other" ? "other movement" : name);
      return entry;
    });
    const none = "no scores: give the board's model with --model FILE";
    find("legend").replaceChildren(...(entries.length ? entries : [none]));
  }

  notice(text) {
    write(find("notice"), text);
  }
}

/** How the armband sits, in words. */
export function placement({ turn, mirrored }) {
  const turned = turn ? `turned by ${turn} place${turn === 1 ? "" : "s"}` : "";
  const parts = [turned, mirrored ? "on the other arm" : ""].filter(Boolean);
  return parts.join(", ") || "as in training";
}

/** What an alignment does, or what came of it, in words. */
export function outcome({ state, gestures }) {
  return (ALIGNMENTS[state] ?? (() => state))(gestures);
}

/** Both. */
export function alignmentText(message) {
  const { distance, margin } = message;
  const quality = distance === null ? "" : ` (distance ${distance / 100}, margin ${margin / 100})`;
  return `${placement(message)}; ${outcome(message)}${quality}`;
}
