// What to do while there is nothing to see: a heading, and steps.

const find = (id) => document.getElementById(id);

/** Time without samples after which an armband is taken to be asleep, in ms. */
const QUIET = 3000;

const ASLEEP = [
  "Put the armband on and move the hand: it sleeps when it is not worn. Its logo pulses when it is awake.",
  "If it stays dark, charge it with its USB cable.",
  "End every other program that may hold it: Myo Connect, a phone, another board.",
];

const UNBOUND = [
  "Press the board's button for a second, or run  myointent board --port PATH bind begin",
  "Wear the armband close to the board for 30 s: the one with the strongest signal is bound.",
];

export class Empty {
  #known = {};
  #since = performance.now();
  #gone = null;
  #shown = "";

  /** Takes any message; most are about something else. */
  take(message) {
    if (message.type === "samples") {
      this.#since = performance.now();
    } else if (message.type === "hello") {
      this.#known = {};
      this.#gone = null;
      this.#since = performance.now();
    } else if (["source", "board", "binding"].includes(message.type)) {
      this.#known[message.type] = message;
      this.#since = message.type === "source" ? performance.now() : this.#since;
    }
  }

  /** The program has ended, or does not answer. */
  gone(hasEnded) {
    this.#gone = hasEnded ? "The program has ended" : "The program does not answer";
  }

  /** Shows what is missing now; to be called every second. */
  show() {
    const [title, steps, demo] = this.#missing() ?? ["", [], false];
    const text = JSON.stringify([title, steps]);
    if (text === this.#shown) {
      return;
    }
    this.#shown = text;
    find("empty").hidden = title === "";
    find("empty-title").textContent = title;
    find("empty-steps").replaceChildren(...steps.map((step) => {
      const item = document.createElement("li");
      item.textContent = step;
      return item;
    }));
    find("empty-demo").hidden = !demo;
  }

  #missing() {
    const { source, board, binding } = this.#known;
    if (this.#gone) {
      return [this.#gone, ["Start it again in its terminal, with the same options: this page finds it by itself."], false];
    }
    if (!source) {
      return null;
    }
    const named = source.kind === "port" ? "The board is not connected" : "No armband streams yet";
    if (!source.connected) {
      return source.steps.length ? [`${named}: ${source.detail}`, source.steps, true] : null;
    }
    if (source.kind !== "port" || performance.now() - this.#since < QUIET) {
      return null;
    }
    if (binding?.state === "nobody") {
      return ["The board follows no armband yet", UNBOUND, true];
    }
    const followed = binding?.armband ? ` ${binding.armband}` : "";
    const first = board?.armband ? `The armband ${board.armband} sends nothing` : `The board looks for its armband${followed}`;
    return [first, ASLEEP, true];
  }
}
