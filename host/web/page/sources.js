// Choice of a source, where the program is inside this page: buttons, a file that is dropped, and what this browser lacks.

import { Radio } from "./bluetooth.js";
import { find } from "./dom.js";
import { Board } from "./serial.js";
import { t } from "./texts.js";

/** Whether a model, which serves all sources from now on, and not a recording. */
const isModel = (name) => name.toLowerCase().endsWith(".intent");

export class Sources {
  #tab;

  constructor(tab) {
    this.#tab = tab;
    find("sources").hidden = false;
    const lacks = [["use-bluetooth", Radio], ["use-board", Board]].filter(([, { works }]) => !works);
    for (const [id] of lacks) {
      find(id).disabled = true;
    }
    find("lacks").hidden = lacks.length === 0;
    find("lacks").textContent = lacks.length === 2 ? t("lacks.both") : lacks.map(([id]) => t(`lacks.${id}`)).join();
    find("use-demo").addEventListener("click", () => this.begin());
    find("use-simulated").addEventListener("click", () => tab.open({ source: "simulated_board" }));
    find("use-bluetooth").addEventListener("click", () => this.#choose(async () => {
      const device = await Radio.choose();
      await this.#tab.open({ source: "bluetooth", name: device.name }, { device });
    }));
    find("use-board").addEventListener("click", () => this.#choose(async () => {
      await this.#tab.open({ source: "port" }, { device: await Board.choose() });
    }));
    find("use-file").addEventListener("click", () => find("file").click());
    find("file").addEventListener("change", () => this.#file(find("file").files[0]));
    addEventListener("dragover", (event) => event.preventDefault());
    addEventListener("drop", (event) => {
      event.preventDefault();
      this.#file(event.dataTransfer.files[0]);
    });
  }

  /** Begins with the simulated arm. */
  begin() {
    this.#tab.open({ source: "demo" });
  }

  /** Chooses a device. A user who chooses none stays with the source that runs. */
  async #choose(device) {
    try {
      await device();
    } catch (error) {
      if (error.name !== "NotFoundError") {
        find("lacks").hidden = false;
        find("lacks").textContent = t("lacks.device", { text: error.message });
      }
    }
  }

  async #file(file) {
    if (!file) {
      return;
    }
    const bytes = new Uint8Array(await file.arrayBuffer());
    if (isModel(file.name)) {
      this.#tab.model(bytes);
      if (document.body.dataset.kind !== "port" || find("source").dataset.state !== "connected") {
        this.begin();
      } else if (confirm(t("install.sure", { name: file.name }))) {
        this.#tab.say({ do: "install" }, bytes);
      }
    } else {
      this.#tab.open({ source: "recording", name: file.name }, { file: bytes });
    }
  }
}
