// Notes on a session, and the scores of its tasks: what is kept with its recordings.

import { find, made } from "./dom.js";
import { t } from "./texts.js";

/** A note or a score, in words. */
export const remark = ({ is, text, score }) => (is === "note" ? text : t("blocks.done", { n: score }));

export class Notes {
  /** Whether a note was sent: its text stays until it is kept. */
  #sent = false;

  constructor(say) {
    find("note-form").addEventListener("submit", (event) => {
      event.preventDefault();
      if (find("note").value.trim()) {
        this.#sent = true;
        say({ do: "note", text: find("note").value });
      }
    });
  }

  take({ remarks }) {
    if (this.#sent && remarks.at(-1)?.is === "note") {
      find("note").value = "";
      this.#sent = false;
    }
    find("remarks").replaceChildren(...remarks.map((one) => made("li", remark(one))));
  }
}
