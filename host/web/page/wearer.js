// View for the person who wears the armband: what to do now, the hand as it is labelled, one word and one colour.

import { classOf } from "./history.js";
import { draw, words } from "./gestures.js";
import { named, t } from "./texts.js";

const ADDRESS = "#wearer";

const find = (id) => document.getElementById(id);

function write(node, text) {
  if (node.textContent !== text) {
    node.textContent = text;
  }
}

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
  show(label, { state, cue }, aligning) {
    if (!this.isShown) {
      return;
    }
    const task = aligning ? t("align.what") : document.body.dataset.mode === "record" ? find("task").textContent : "";
    write(find("worn-do"), task || (cue ? words(cue) : t("wearer.free")));
    write(find("worn-word"), label === null ? t("wearer.none") : named("class", label));
    const sign = { right: t("wearer.right"), wrong: t("wearer.wrong") };
    write(find("worn-sign"), label === null ? find("valid").textContent : sign[state] ?? "");
    find("worn-sign").dataset.state = label === null ? "none" : state;
    find("worn").dataset.label = label === null ? "none" : classOf(label);
    draw(find("worn-hand"), label);
  }
}
