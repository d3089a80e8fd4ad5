// A recording session: what to do now, what comes next and how long. The program leads; the page shows and passes on keys.

import { RATE } from "./clock.js";
import { button, find, made, write } from "./dom.js";
import { Ending } from "./ending.js";
import { draw, words } from "./gestures.js";
import { Result } from "./result.js";
import { CLASSES, classOf } from "./history.js";
import { named, said, t } from "./texts.js";

const KEYS = { b: "bind", k: "skip", Enter: "begin", r: "repeat", h: "hold", e: "finish", t: "tune", i: "install", n: "again" };
const BUTTONS = ["begin", "repeat", "hold", "finish"];
/** Gestures by the number of their key. */
const MARKS = [...CLASSES, "other"];

const still = matchMedia("(prefers-reduced-motion: reduce)");

function clockTime(samples) {
  const seconds = Math.max(0, Math.ceil(samples / RATE));
  return `${Math.floor(seconds / 60)}:${String(seconds % 60).padStart(2, "0")}`;
}

export class Session {
  #say;
  #you = null;
  #leader = null;
  #view = null;
  #result = new Result();
  #root = find("session");
  #ending;

  constructor(say) {
    this.#say = say;
    this.#ending = new Ending(say);
    for (const id of ["begin", "repeat", "hold", "tune", "install", "again"]) {
      find(id).addEventListener("click", () => say({ do: "session", wish: id }));
    }
    find("finish").addEventListener("click", () => this.#ending.ask(this.#view));
  }

  /** Whether the task goes on: the picture must not stand still then. */
  get isRunning() {
    return this.#view?.phase === "ready" || this.#view?.phase === "cued";
  }

  hello({ you, record, tunes }) {
    this.#you = you;
    this.#leader = null;
    find("lead").hidden = this.#root.hidden = !record;
    document.body.dataset.mode = record ? "record" : "live";
    const title = t(record ? "title.record" : "title");
    write(find("title"), title);
    document.title = `myointent ${title}`;
    // Without a program there is no record but what is saved.
    find("history").hidden = !record || Boolean(find("program"));
    find("notes").hidden = !record;
    find("tune").hidden = !tunes;
    find("untuned").hidden = tunes;
  }

  lead({ viewer }) {
    this.#leader = viewer;
    this.#buttons();
  }

  show(view) {
    const another = this.#view?.phase === "over" && view.phase === "waiting";
    this.#view = view;
    this.#root.dataset.phase = view.phase;
    this.#root.dataset.free = view.free;
    this.#root.dataset.label = classOf(view.cue ?? view.coming[0]?.cue ?? "relax");
    if (another) {
      this.#result.clear();
    }
    if (view.phase === "over" || view.phase === "waiting") {
      this.#ending.close();
    }
    this.#task();
    this.#next();
    this.#coming();
    this.#marks();
    this.#buttons();
    find("trouble").hidden = !view.trouble;
    write(find("trouble"), said(view.trouble));
  }

  kept(message) {
    this.#result.kept(message);
    this.#buttons();
    find("result").scrollIntoView({ block: "nearest", behavior: still.matches ? "auto" : "smooth" });
  }

  tuning(message) {
    this.#result.tuning(message);
    this.#buttons();
  }

  installing(message) {
    this.#result.installing(message);
    this.#buttons();
  }

  /** Whether a question is asked, to which all keys belong. */
  get isAsking() {
    return this.#ending.isAsking;
  }

  /** Whether a key is one of the session's. */
  key(event) {
    if (this.#root.hidden || event.repeat) {
      return false;
    }
    const name = event.key.length === 1 ? event.key.toLowerCase() : event.key;
    if (this.isAsking) {
      return this.#ending.key(name);
    }
    const id = name === " " ? this.#spaceKey() : KEYS[name];
    if (id && !(["Enter", " "].includes(name) && event.target instanceof HTMLButtonElement)) {
      const button = find(id);
      if (!button.disabled && button.offsetParent !== null) {
        button.click();
      }
      return true;
    }
    const gesture = this.#view?.free ? MARKS[Number(name)] : undefined;
    if (gesture && /^[0-6]$/.test(name) && this.#view.classes.includes(gesture)) {
      this.#say({ do: "gesture", class: gesture });
      return true;
    }
    return false;
  }

  // The task would go on behind a picture that stands: in a session the space bar has both wait.
  #spaceKey() {
    return this.isRunning ? "hold" : this.#view?.phase === "held" ? "begin" : undefined;
  }

  /** The countdown, at a position of the stream. */
  frame(position) {
    const view = this.#view;
    if (!view || this.#root.hidden) {
      return;
    }
    const { from, end } = view;
    const runs = from !== null && (view.phase === "ready" || view.phase === "cued");
    const passed = runs ? Math.max(0, position - from) : 0;
    if (runs && end !== null) {
      const left = Math.max(0, end - Math.max(position, from));
      write(find("count"), String(Math.ceil(left / RATE)));
      const whole = end - from;
      const shown = still.matches ? Math.ceil(left / RATE) * RATE : left;
      find("bar").firstElementChild.style.width = `${Math.min(100, (100 * shown) / whole)}%`;
    } else {
      write(find("count"), runs ? clockTime(passed) : "");
      find("bar").firstElementChild.style.width = "0";
    }
    this.#progress(passed);
  }

  #progress(passed) {
    const { phase, round, rounds, done, trials, left, bad, free, protocol } = this.#view;
    const parts = [];
    if (free) {
      parts.push(t("protocol", { name: protocol }));
    } else if (phase === "waiting") {
      parts.push(t("protocol", { name: protocol }), t("rounds", { n: rounds }), clockTime(left));
    } else if (phase !== "over") {
      parts.push(t("round", { round, rounds }), t("done.of", { done, trials }), t("left", { time: clockTime(left - passed) }));
    }
    if (bad) {
      parts.push(t("not.used", { n: bad }));
    }
    write(find("progress"), parts.join(" · "));
  }

  #task() {
    const { phase, why, cue, coming, free } = this.#view;
    const picture = { cued: cue, ready: "relax", waiting: "relax" }[phase] ?? null;
    draw(find("hand"), picture ?? (phase === "held" ? "relax" : null));
    const tasks = {
      waiting: t("task.waiting"),
      ready: t("task.ready"),
      cued: words(cue),
      held: why ? named("held", why) : "",
      over: t("task.over"),
    };
    write(find("task"), tasks[phase]);
    const hints = {
      waiting: t(free ? "how.waiting.free" : "how.waiting"),
      ready: coming.length ? t("how.ready") : "",
      // Other movement says itself how it is done.
      cued: free ? t("how.free") : ["relax", "other"].includes(cue) ? t(`how.${cue}`) : CLASSES.includes(cue) ? t("how.gesture") : "",
      held: why ? named("hint", why) : "",
      over: "",
    };
    write(find("hint"), hints[phase]);
    write(find("begin").firstElementChild, t(phase === "held" ? "go.on" : "begin"));
  }

  #next() {
    const next = this.#view.coming[0]?.cue ?? null;
    draw(find("next-hand"), next);
    write(find("next"), next ? words(next) : "");
    find("next-title").hidden = next === null;
  }

  #coming() {
    const chips = this.#view.coming.map(({ cue, samples }) => {
      const chip = made("li", `${named("class", cue)} ${t("seconds", { n: samples / RATE })}`, { title: words(cue) });
      chip.dataset.label = classOf(cue);
      return chip;
    });
    find("coming").replaceChildren(...chips);
  }

  #marks() {
    const { free, classes, cue } = this.#view;
    find("marks").hidden = !free;
    if (!free) {
      return;
    }
    if (!find("marks").childElementCount) {
      find("marks").append(...classes.map((name) => {
        const mark = button(`${named("class", name)} `, () => this.#say({ do: "gesture", class: name }));
        mark.dataset.label = name;
        mark.append(made("kbd", MARKS.indexOf(name)));
        return mark;
      }));
    }
    for (const mark of find("marks").children) {
      mark.setAttribute("aria-pressed", String(mark.dataset.label === cue));
    }
  }

  #watches() {
    return this.#leader !== null && this.#leader !== this.#you;
  }

  #buttons() {
    const view = this.#view;
    if (!view) {
      return;
    }
    const running = view.phase === "ready" || view.phase === "cued";
    const shown = {
      begin: view.phase === "waiting" || view.phase === "held",
      repeat: running,
      hold: running,
      finish: running || view.phase === "held",
    };
    const watches = this.#watches();
    for (const own of find("note-form").elements) {
      own.disabled = watches;
    }
    find("language").disabled = find("sources").inert = running;
    find("pause").hidden = find("calibrate").hidden = find("play").hidden = running;
    for (const id of BUTTONS) {
      find(id).hidden = !shown[id];
      find(id).disabled = watches || id === "repeat" && !view.can_repeat;
    }
    find("again").disabled = watches || this.#result.isInstalling || view.phase !== "over";
    find("tune").disabled = watches || this.#result.isTuning || this.#result.isInstalling;
    find("install").disabled = watches || this.#result.isInstalling;
    for (const id of ["keep", "tune", "again", "install"]) {
      find(id).classList.toggle("main", id === this.#result.next);
    }
    write(find("watching"), watches ? t("watching") : "");
    for (const mark of find("marks").children) {
      mark.disabled = view.phase !== "cued" || watches;
    }
  }
}
