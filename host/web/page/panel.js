// Numbers and texts around the traces. Only what has changed is written to the document.

import { WEAK } from "./armband.js";
import { find, made, write } from "./dom.js";
import { named, t } from "./texts.js";

export class Panel {
  #passing = 0;

  source(state, text) {
    const node = find("source");
    node.dataset.state = state;
    write(node.querySelector("span"), text);
  }

  report({ lost, bridged, resets, emitted, instant, is_label: isLabel }) {
    if (isLabel) {
      this.number("delay", t("ms", { n: (emitted - instant) * 5 }));
    }
    this.number("lost", lost ? t("lost.all", { n: resets, lost, bridged, resets }) : "0");
  }

  /** Strength of the contraction in percent of the wearer's own range; null where it is unknown. */
  strength(percent) {
    find("strong").hidden = percent === null;
    find("strength").value = percent ?? 0;
  }

  /** What the strengths of the electrodes mean: { times, faults }. Where one has a fault, that is mended first. */
  strengths({ times, faults }) {
    const weak = times?.flatMap((own, at) => (own < WEAK ? [at + 1] : [])) ?? [];
    const key = !times ? "strengths.unknown" : weak.length ? "strengths.weak" : "strengths.good";
    write(find("strengths"), faults.some(Boolean) ? "" : t(key, { n: weak.length, weak: weak.join(", ") }));
  }

  number(id, text) {
    write(find(id), text);
  }

  legend(model) {
    const names = model ? [...model.classes, ...(model.other ? ["other"] : [])] : [];
    const entries = names.map((name) => {
      const entry = made("span", "", { className: name });
      entry.append(made("i"), name === "other" ? t("other.movement") : named("class", name));
      return entry;
    });
    find("legend").replaceChildren(...(entries.length ? entries : [t(find("sources").hidden ? "no.scores" : "no.scores.here")]));
  }

  /** Shows a notice until the next one, or for so many ms. */
  notice(text, ms = null) {
    clearTimeout(this.#passing);
    write(find("notice"), text);
    if (ms !== null) {
      this.#passing = setTimeout(() => this.notice(""), ms);
    }
  }
}
