// The program inside this page: a worker runs the pipeline, and the browser reaches the devices.

import { find } from "./dom.js";
import { Recordings } from "./recordings.js";
import { Sources } from "./sources.js";
import { t } from "./texts.js";

const text = (id) => find(id).textContent;

export class Tab {
  #calls;
  #code = Uint8Array.from(atob(text("program")), (letter) => letter.charCodeAt(0));
  #address = URL.createObjectURL(new Blob([text("worker")], { type: "text/javascript" }));
  #model = null;
  #worker = null;
  #device = null;
  #turn = 0;
  #recordings = new Recordings(this);

  constructor(calls) {
    this.#calls = calls;
    const sources = new Sources(this);
    sources.begin();
  }

  /** Passes on a message, and the journal or model that it is about. */
  say(message, file) {
    this.#worker?.postMessage({ request: JSON.stringify(message), file });
  }

  /** Takes a model file, for the sources from now on. */
  model(bytes) {
    this.#model = bytes;
  }

  /** Begins a source: its name and what belongs to it; its device, if it has one; and the bytes of its file. The one before ends. */
  async open(wanted, { device = null, file = null } = {}) {
    const turn = this.#turn += 1;
    this.#worker?.terminate();
    this.#worker = null;
    const before = this.#device;
    this.#device = device;
    await before?.close();
    if (turn !== this.#turn) {
      return;
    }
    this.#calls.begun();
    const worker = new Worker(this.#address);
    this.#worker = worker;
    const heard = (bytes, now) => worker.postMessage({ heard: bytes, now });
    let isOpen = false;
    worker.onmessage = ({ data }) => {
      const messages = JSON.parse(data);
      const forPage = messages.filter(({ type }) => type);
      if (worker === this.#worker && forPage.length) {
        this.#calls.take(forPage);
      }
      if (!isOpen) {
        isOpen = true;
        this.#calls.opened();
        device?.run(heard, () => this.#lost(worker, t("source.unplugged")));
      }
      for (const message of messages.filter(({ type }) => !type)) {
        if (message.journal) {
          this.#recordings.append(message);
        } else {
          device?.take(message);
        }
      }
    };
    worker.onerror = () => this.#lost(worker, t("source.stopped"));
    worker.postMessage({ code: this.#code, model: this.#model, file, wanted: JSON.stringify(wanted), origin: performance.timeOrigin, ticks: wanted.source !== "bluetooth" });
  }

  #lost(worker, text) {
    if (worker === this.#worker) {
      worker.terminate();
      this.#worker = null;
      this.#calls.closed(text, [text, t("empty.choose")]);
    }
  }
}
