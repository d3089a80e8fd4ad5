// Steps to a model of one's own: which are done, which one is now; and what connecting, binding and aligning ask for.

import { outcome, placement } from "./placement.js";

const NAMES = { connect: "Connect", bind: "Bind", align: "Align", record: "Record", tune: "Tune", compare: "Compare", install: "Install" };
const FOLLOWS = ["bound", "built-in", "strongest"];
const ALIGNED = ["aligned", "set"];
const FAILED = ["poor-distance", "poor-margin", "timeout", "cancelled", "unavailable"];

const SKIPPED = "alignment is skipped";
const BIND = "Put yours on, close to the board; keep other people's out of the room, or asleep. The one with the strongest signal of the next 30 s is bound.";
const ALIGN = "Press Align and rest; open the hand wide for a second, rest for a second, and the same once more. If you know that it sits as in training (bending the wrist back is strongest on electrode 3), it is better left as it is.";

const find = (id) => document.getElementById(id);

const sentence = (text) => `${text[0].toUpperCase()}${text.slice(1)}.`;

function made(name, text, className = "") {
  const node = document.createElement(name);
  node.textContent = text;
  node.className = className;
  return node;
}

export class Steps {
  /** The newest message of each of these types. */
  #known = {};
  /** Whether the last pairing heard no armband. */
  #missed = false;
  /** Kept by the browser until this tab is closed: a page that is loaded again does not ask again. */
  #skipped = sessionStorage.getItem(SKIPPED) !== null;
  #shown = "";

  constructor(say) {
    find("bind").addEventListener("click", () => say({ do: "bind" }));
    find("align-now").addEventListener("click", () => find("align").click());
    find("skip").addEventListener("click", () => {
      this.#skipped = true;
      sessionStorage.setItem(SKIPPED, "yes");
      this.#show();
    });
  }

  /** Takes any message; most are about something else. */
  take(message) {
    const known = this.#known;
    switch (message.type) {
      case "hello":
        this.#known = {};
        break;
      case "binding":
        this.#missed = message.state === "nobody" && (known.binding?.state === "pairing" || this.#missed);
        known.binding = message;
        break;
      case "session":
        if (message.phase === "waiting" && known.session?.phase === "over") {
          known.kept = known.tuning = known.installing = null;
        }
        known.session = message;
        break;
      case "source":
        known.source = message;
        if (!message.connected) {
          known.report = null;
        }
        break;
      case "report": case "alignment": case "kept": case "tuning": case "installing":
        known[message.type] = message;
        break;
      default:
        return;
    }
    this.#show();
  }

  /** [name, whether it is done, what is known of it] of each step that this source has. */
  #steps() {
    const { source, binding, alignment, session, kept, tuning, installing } = this.#known;
    const board = source?.kind === "port";
    const begun = session && session.phase !== "waiting";
    const percent = ({ steps, of }) => `${Math.floor((100 * steps) / (of || 1))} %`;
    const judged = tuning?.state === "better" || tuning?.state === "worse";
    const [balanced] = judged ? tuning.rows : [];
    const compared = balanced && balanced.before !== null && balanced.after !== null;
    const aligned = alignment && (ALIGNED.includes(alignment.state) || alignment.turn > 0 || alignment.mirrored);
    const all = [
      ["connect", source?.connected || installing?.state === "running", board ? "the board" : ""],
      board && ["bind", this.#follows(), binding?.state === "pairing" ? "listening" : binding?.armband ?? ""],
      (board || source?.kind === "bluetooth") && ["align", aligned || this.#skipped || begun, aligned ? placement(alignment) : this.#skipped || begun ? "left as it is" : ""],
      ["record", kept, kept ? (kept.good ? "good enough" : "not good enough yet") : ""],
      ["tune", judged, tuning?.state === "running" ? percent(tuning) : tuning?.state === "failed" ? "failed" : ""],
      ["compare", judged, compared ? `${balanced.before.toFixed(2)}, tuned ${balanced.after.toFixed(2)}` : ""],
      board && ["install", installing?.state === "done", installing?.state === "running" ? percent({ steps: installing.blocks, of: installing.of }) : installing?.state === "failed" ? "failed" : ""],
    ];
    return all.filter(Boolean);
  }

  /** Whether the board follows an armband; one that streams is followed, whatever was heard of it. */
  #follows() {
    const { binding, report } = this.#known;
    return binding ? FOLLOWS.includes(binding.state) : Boolean(report?.valid);
  }

  #show() {
    const steps = this.#steps();
    const worse = this.#known.tuning?.state === "worse";
    const now = steps.find(([name, done]) => !done && !(worse && name === "install"))?.[0] ?? null;
    const text = JSON.stringify([steps, now, this.#asked(now)]);
    if (text === this.#shown) {
      return;
    }
    this.#shown = text;
    find("steps").replaceChildren(...steps.map(([name, done, detail]) => {
      const item = document.createElement("li");
      const state = done ? "done" : name === now ? "now" : "next";
      item.id = `step-${name}`;
      item.dataset.state = state;
      if (state === "now") {
        item.setAttribute("aria-current", "step");
      }
      item.append(made("b", NAMES[name]), made("span", done ? ", done" : "", "unseen"), made("span", detail, "detail"));
      return item;
    }));
    this.#ask(now);
  }

  /** What a step before the recording asks for: task, hint, its buttons, and the main one of them. */
  #asked(now) {
    const { source, binding, alignment, report, session } = this.#known;
    if (session?.phase !== "waiting") {
      return null;
    }
    if (now === "connect") {
      return ["Waiting for the source", source?.detail ?? "", [], null];
    }
    if (now === "bind") {
      return {
        pairing: ["Listening for armbands", "Wear yours close to the board. The one with the strongest signal of these 30 s is bound.", [], null],
        nobody: ["Bind your armband", `${this.#missed ? "No armband was heard." : "The board follows none yet."} ${BIND}`, ["bind"], "bind"],
      }[binding?.state] ?? ["Asking the board", "Which armband does it follow?", [], null];
    }
    if (now !== "align") {
      return null;
    }
    if (alignment?.state === "waiting") {
      return ["Open the hand wide, twice", sentence(outcome(alignment)), ["align-now", "skip"], null];
    }
    if (!report?.valid) {
      const followed = binding?.armband ? `The board follows ${binding.armband}. ` : "";
      return ["Put the armband on", `${followed}Labels come 3 s after its signal.`, binding ? ["bind"] : [], null];
    }
    const before = FAILED.includes(alignment?.state) ? `${sentence(outcome(alignment))} ` : "";
    return alignment?.state === "unavailable"
      ? ["It cannot be aligned", before, ["skip"], "skip"]
      : ["Align the armband", before + ALIGN, ["align-now", "skip"], "align-now"];
  }

  #ask(now) {
    const asked = this.#asked(now);
    find("setup").hidden = !asked;
    const [task, hint, buttons, main] = asked ?? ["", "", [], null];
    for (const [id, text] of [["setup-task", task], ["setup-hint", hint]]) {
      if (find(id).textContent !== text) {
        find(id).textContent = text;
      }
    }
    for (const id of ["bind", "align-now", "skip"]) {
      find(id).hidden = !buttons.includes(id);
      find(id).classList.toggle("main", id === main);
    }
    find("align-now").firstElementChild.textContent = this.#known.alignment?.state === "waiting" ? "Stop" : "Align";
    find("bind").firstElementChild.textContent = now === "align" ? "Not yours? Bind another" : "Bind it";
  }
}
