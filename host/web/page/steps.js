// Steps to a model of one's own: which are done, which one is now; and what connecting, binding and aligning ask for.

import { find, made, write } from "./dom.js";
import { outcome, placement } from "./placement.js";
import { measured } from "./result.js";
import { keep, kept } from "./stored.js";
import { capital, said, t } from "./texts.js";

const FOLLOWS = ["bound", "built-in", "strongest"];
const ALIGNED = ["aligned", "set"];
const FAILED = ["poor-distance", "poor-margin", "timeout", "cancelled", "unavailable"];

const SKIPPED = "alignment is skipped";


export class Steps {
  /** The newest message of each of these types. */
  #known = {};
  /** Whether the last pairing heard no armband. */
  #missed = false;
  /** Kept by the browser until this tab is closed: a page that is loaded again does not ask again. */
  #skipped = kept("tab", SKIPPED) !== null;
  #shown = "";

  constructor(say) {
    find("bind").addEventListener("click", () => say({ do: "bind" }));
    find("align-now").addEventListener("click", () => find("align").click());
    find("skip").addEventListener("click", () => {
      this.#skipped = true;
      keep("tab", SKIPPED, "yes");
      this.#show();
    });
  }

  /** Takes any message; most are about something else. */
  take(message) {
    const known = this.#known;
    switch (message.type) {
      case "hello":
        this.#known = { hello: message };
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
    const { hello, source, binding, alignment, session, kept, tuning, installing } = this.#known;
    const board = source?.kind === "port";
    const tunes = hello?.tunes;
    const begun = session && session.phase !== "waiting";
    const percent = ({ steps, of }) => `${Math.floor((100 * steps) / (of || 1))} %`;
    const judged = tuning?.state === "better" || tuning?.state === "worse";
    const [balanced] = judged ? tuning.rows : [];
    const compared = balanced && balanced.before !== null && balanced.after !== null;
    const aligned = alignment && (ALIGNED.includes(alignment.state) || alignment.turn > 0 || alignment.mirrored);
    const all = [
      ["connect", source?.connected || installing?.state === "running", board ? t("step.the.board") : ""],
      board && ["bind", this.#follows(), binding?.state === "pairing" ? t("step.listening") : binding?.armband ?? ""],
      (board || source?.kind === "bluetooth") && ["align", aligned || this.#skipped || begun, aligned ? placement(alignment) : this.#skipped || begun ? t("step.left") : ""],
      ["record", kept?.good || judged, kept ? (t(kept.good ? "step.good" : "step.not.good")) : ""],
      tunes && ["tune", judged, tuning?.state === "running" ? percent(tuning) : tuning?.state === "failed" ? t("step.failed") : ""],
      tunes && ["compare", judged, compared ? t("step.compared", { before: measured("balanced-accuracy", balanced.before), after: measured("balanced-accuracy", balanced.after) }) : ""],
      tunes && ["install", installing?.state === "done", installing?.state === "running" ? percent({ steps: installing.blocks, of: installing.of }) : installing?.state === "failed" ? t("step.failed") : ""],
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
      const item = made("li", "", { id: `step-${name}`, ariaCurrent: name === now && !done ? "step" : null });
      item.dataset.state = done ? "done" : name === now ? "now" : "next";
      item.append(made("b", t(name === "install" && this.#known.source?.kind !== "port" ? "step.use" : `step.${name}`)), made("span", done ? t("step.done") : "", { className: "unseen" }), made("span", detail, { className: "detail" }));
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
      return [t("ask.source"), said(source?.detail), [], null];
    }
    if (now === "bind") {
      return {
        pairing: [t("ask.listening"), t("ask.listening.how"), [], null],
        nobody: [t("ask.bind"), `${t(this.#missed ? "ask.bind.unheard" : "ask.bind.none")} ${t("ask.bind.how")}`, ["bind"], "bind"],
      }[binding?.state] ?? [t("ask.board"), t("ask.board.how"), [], null];
    }
    if (now !== "align") {
      return null;
    }
    if (alignment?.state === "waiting") {
      return [t("ask.open"), `${capital(outcome(alignment))}.`, ["align-now", "skip"], null];
    }
    if (!report?.valid) {
      const followed = binding?.armband ? `${t("ask.follows", { address: binding.armband })} ` : "";
      return [t("ask.put.on"), followed + t("ask.put.on.how"), binding ? ["bind"] : [], null];
    }
    const before = FAILED.includes(alignment?.state) ? `${capital(outcome(alignment))}. ` : "";
    return alignment?.state === "unavailable"
      ? [t("ask.unavailable"), before, ["skip"], "skip"]
      : [t("ask.align"), before + t("ask.align.how"), ["align-now", "skip"], "align-now"];
  }

  #ask(now) {
    const asked = this.#asked(now);
    find("setup").hidden = !asked;
    const [task, hint, buttons, main] = asked ?? ["", "", [], null];
    write(find("setup-task"), task);
    write(find("setup-hint"), hint);
    for (const id of ["bind", "align-now", "skip"]) {
      find(id).hidden = !buttons.includes(id);
      find(id).classList.toggle("main", id === main);
    }
    find("align-now").firstElementChild.textContent = this.#known.alignment?.state === "waiting" ? t("align.stop") : t("align");
    find("bind").firstElementChild.textContent = t(now === "align" ? "bind.another" : "bind");
  }
}
