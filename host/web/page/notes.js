// Notes on a session, and the scores of its tasks: what is kept with its recordings.

import { find, made } from "./dom.js";
import { t } from "./texts.js";

/** A note or a score, in words. */
export const remark = ({ is, text, score }) => (is === "note" ? text : t("blocks.done", { n: score }));

export class Notes {
  constructor(say) {
    find("note-form").addEventListener("submit", (event) => {
      event.preventDefault();
      if (find("note").value.trim()) {
        say({ do: "note", text: find("note").value });
        find("note").value = "";
      }
    });
  }

  take({ remarks }) {
    find("remarks").replaceChildren(...remarks.map((one) => made("li", remark(one))));
  }
}
