// View for the person who wears the armband, on one screen: what to do now, a hand, one word and one colour. The hand is the one
// that is asked for, in a session, a calibration or a task with how far it is and what comes next; else the labelled one.

import { find, write } from "./dom.js";
import { classOf } from "./history.js";
import { draw, words } from "./gestures.js";
import { named, t } from "./texts.js";

const ADDRESS = "#wearer";

export class Wearer {
  constructor() {
    const turn = () => {
      location.hash = location.hash === ADDRESS ? "" : ADDRESS;
    };
    find("wearer").addEventListener("click", turn);
    find("worn-back").addEventListener("click", turn);
    addEventListener("hashchange", () => this.#turned());
    this.#turned();
  }

  get isShown() {
    return location.hash === ADDRESS;
  }

  #turned() {
    find("worn").hidden = !this.isShown;
    document.body.dataset.view = this.isShown ? "wearer" : "all";
  }

  /** Shows a label, null without one, whether it is what was asked for, and what is asked for: an alignment before all. */
  show(label, { state, cue, means }, aligning) {
    if (!this.isShown) {
      return;
    }
    const guided = !find("guide").hidden;
    const inSession = guided || document.body.dataset.mode === "record";
    const [does, hands, counts, comes] = guided ? ["guide-task", "guide-hand", "guide-count", "guide-then"] : ["task", "hand", "count", "next"];
    const task = aligning ? t("align.what") : inSession ? find(does).textContent : "";
    write(find("worn-do"), task || (cue ? words(cue) : t("wearer.free")));
    // Movement that means nothing is neither right nor wrong.
    const judged = label === null || !means ? "none" : state;
    const signs = [label === null ? find("valid").textContent : { right: t("wearer.right"), wrong: t("wearer.wrong") }[judged]];
    if (cue && label !== null && !inSession) {
      signs.push(t("wearer.seen", { label: named("class", label) }));
    }
    if (guided) {
      signs.push(find("guide-left").textContent);
    }
    if (inSession && find(comes).textContent) {
      signs.push(t("wearer.next", { what: find(comes).textContent }));
    }
    write(find("worn-sign"), signs.filter(Boolean).join(" · "));
    find("worn-sign").dataset.state = judged;
    const hand = inSession ? find(hands).dataset.gesture || null : label === null ? null : cue ?? label;
    const word = label === null ? t("wearer.none") : named("class", cue ?? label);
    write(find("worn-word"), inSession ? find(counts).textContent : word);
    find("worn").dataset.label = hand === null ? "none" : classOf(hand);
    draw(find("worn-hand"), hand);
  }
}
