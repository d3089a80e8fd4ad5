// Recording in the page that needs no program: who, by which protocol, and the sessions that this browser keeps.

import { button, find, made } from "./dom.js";
import { Store } from "./store.js";
import { keep, kept } from "./stored.js";
import { t } from "./texts.js";

const PERSON = "person";
const PROTOCOLS = ["quick", "quick-five", "quick-six", "daily", "paper", "free"];

export class Recordings {
  #tab;
  #store = new Store();
  #dialog = find("recording");

  constructor(tab) {
    this.#tab = tab;
    find("protocol").replaceChildren(...PROTOCOLS.map((name) => new Option(t(`protocol.${name}`), name)));
    find("person").value = kept("always", PERSON) ?? "";
    find("use-record").addEventListener("click", () => this.#open());
    find("record-now").addEventListener("click", () => this.#record());
    find("record-close").addEventListener("click", () => this.#dialog.close());
    find("keep").addEventListener("click", () => tab.say({ do: "keep" }));
    find("keep").hidden = false;
  }

  /** Keeps lines of the session that is recorded. */
  async append({ name, journal }) {
    try {
      await this.#store.append(name, journal);
    } catch {
      find("unsaved").hidden = false;
    }
  }

  async #open() {
    find("record-now").disabled = !["demo", "port", "bluetooth"].includes(document.body.dataset.kind);
    find("kept-verdict").textContent = "";
    this.#dialog.showModal();
    await this.#list();
  }

  async #list() {
    const names = await this.#store.names().catch(() => []);
    find("kept-before").hidden = names.length === 0;
    find("kept-list").replaceChildren(...names.reverse().map((name) => {
      const item = made("li");
      item.append(made("span", name), button(t("keep"), () => this.#recover(name)), button(t("delete"), () => this.#remove(name)));
      return item;
    }));
  }

  #record() {
    if (find("person").reportValidity()) {
      const person = find("person").value;
      keep("always", PERSON, person);
      this.#tab.say({ do: "record", person, protocol: find("protocol").value, time: Date.now() });
      this.#dialog.close();
      // The keys are the session's.
      find("use-record").blur();
    }
  }

  async #recover(name) {
    find("kept-verdict").textContent = "";
    this.#tab.say({ do: "recover", name }, await this.#store.read(name));
    this.#tab.say({ do: "keep" });
  }

  async #remove(name) {
    if (confirm(t("delete.sure", { name }))) {
      await this.#store.remove(name);
      await this.#list();
    }
  }
}
