// Result of a session: whether it is good enough, why not, and what comes next.

import { button, find, made, write } from "./dom.js";
import { capital, fixed, named, said, t } from "./texts.js";

/** A command with what it does, and a button that copies it; without leave to, it is selected. */
function command(text, what) {
  const box = made("div", "", { className: "command" });
  const code = made("code", text);
  const copy = button(t("copy"), async () => {
    try {
      await navigator.clipboard.writeText(text);
      copy.textContent = t("copied");
    } catch {
      getSelection().selectAllChildren(code);
      copy.textContent = t("selected");
    }
  });
  copy.ariaLabel = t("copy.what", { what });
  box.append(made("span", what, { className: "quiet" }), code, copy);
  return box;
}

/** Two bars for a measure, before and after, on a scale of their own; the numbers stand beside them. */
function bars(before, after) {
  const cell = made("td", "", { className: "bars", ariaHidden: "true" });
  const whole = Math.max(1, before ?? 0, after ?? 0);
  cell.append(...[before, after].map((value) => {
    const bar = made("i");
    bar.style.width = `${(100 * (value ?? 0)) / whole}%`;
    return bar;
  }));
  return cell;
}

/** Whether the source is a board, on which a model is installed; others run it here. */
const isBoard = () => document.body.dataset.kind === "port";

/** Headlines after a tuning. */
const HEADLINES = { better: t("better"), worse: t("worse.model") };

/** Measures that are numbers a minute. */
const RATES = ["at-rest", "in-others"];

/** A value of a measure: a number a minute, or a share in per cent; a dash without one. */
export const measured = (measure, value) =>
  value === null ? "–" : RATES.includes(measure) ? fixed(value, 1) : t("percent", { share: fixed(100 * value, 0) });

/** What is said of a tuning. */
export function tuned({ state, why, steps, of, rows, tuned_seconds, judged_seconds, file, doubts }) {
  if (state === "running") {
    return t(steps === of ? "tuning.judged" : "tuning.steps");
  }
  if (state === "failed") {
    return said(why);
  }
  const known = rows.filter(({ measure, before, after }) => ["recognised", "in-others"].includes(measure) && before !== null && after !== null);
  const halves = known.map(({ measure, before, after }) =>
    t(`tuned.${measure}`, { before: measured(measure, before), after: measured(measure, after) }));
  return [
    ...(why ? [`${said(why)}.`] : []),
    t("tuned.on", { judged: fixed(judged_seconds, 0), tuned: fixed(tuned_seconds, 0) }),
    ...halves,
    file ? t("tuned.file", { file }) : t("tuned.nothing"),
    ...doubts.map((doubt) => `${capital(said(doubt))}.`),
  ].join(" ");
}

/** What is said of an installation: a word, and a sentence. */
export function installation({ state, why, goes_on, model }) {
  const done = () => t(isBoard() ? "installed.board" : "installed.here", { model });
  const failed = () => (goes_on ? t("install.again", { why: said(why) }) : said(why));
  const text = why ? failed() : state === "done" ? done() : t("installing.safe");
  return [t(`installing.${state}`), text];
}

export class Result {
  isTuning = false;
  isInstalling = false;
  /** The button that comes next; null if none does. */
  next = null;
  #kept = null;

  kept(message) {
    this.#kept = message;
    const { good, seconds, folder, files, counts, bad, findings } = message;
    find("result").hidden = false;
    find("verdict").textContent = t(good ? "good" : "not.good");
    find("verdict").dataset.good = good;
    const each = counts.map(([name, count]) => t("times", { name: named("class", name), count })).join(", ");
    const unused = bad ? t("unused", { n: bad }) : "";
    find("amount").textContent = t("kept", { n: files.length, seconds: fixed(seconds, 0), each, unused, folder });
    find("findings").replaceChildren(...findings.map(({ severity, advice, ...finding }) => {
      const item = made("li", "", { className: severity });
      item.append(made("b", t(severity)), made("span", said(finding)), made("span", said({ text: advice, name: finding.name.replace("finding", "advice") }), { className: "quiet" }));
      return item;
    }));
    // Of a session that was kept before, the dialog alone is shown.
    const lines = [...find("findings").children].map(({ children }) => [...children].map((part) => part.textContent).join(" "));
    find("kept-verdict").textContent = [find("verdict").textContent, find("amount").textContent, ...lines].join("\n");
    this.next = !find("keep").hidden ? "keep" : good && !find("tune").hidden ? "tune" : "again";
    this.#scores([]);
    this.#taken(null);
    find("tuned").textContent = "";
    this.#install(false);
    this.#commands([]);
  }

  tuning(message) {
    const { state, steps, of, rows, commands } = message;
    this.isTuning = state === "running";
    this.next = { better: "install", worse: "again", failed: this.#kept?.good ? "tune" : "again" }[state] ?? null;
    this.#told("tuned", state, t(`tuning.${state}`), tuned(message));
    if (HEADLINES[state]) {
      find("verdict").textContent = HEADLINES[state];
      find("verdict").dataset.good = state === "better";
    }
    this.#taken(this.isTuning ? steps / (of || 1) : null);
    this.#scores(rows);
    this.#install(state === "better");
    if (state !== "running") {
      this.#commands(commands);
    }
  }

  installing(message) {
    const { state } = message;
    this.isInstalling = state === "running";
    this.next = state === "done" ? null : "install";
    find("install").hidden = state === "done";
    this.#told("installed", state, ...installation(message));
  }

  clear() {
    this.#kept = null;
    this.isTuning = false;
    this.next = null;
    this.#taken(null);
    this.#install(false);
    find("result").hidden = true;
  }

  // As it goes on, the bar alone changes: the sentence is read out once.
  #told(id, state, word, text) {
    const told = find(id);
    if (told.textContent !== `${word} ${text}`) {
      told.dataset.state = state;
      told.replaceChildren(made("b", word), ` ${text}`);
    }
  }

  /** The share of a tuning's steps that are taken; null if none is in progress. */
  #taken(share) {
    find("taken").hidden = find("percent").hidden = share === null;
    find("taken").value = share ?? 0;
    find("percent").textContent = `${Math.floor(100 * (share ?? 0))} %`;
  }

  /** Whether there is something to put on a board; nothing is known of it yet. */
  #install(offered) {
    this.isInstalling = false;
    find("install").hidden = !offered;
    write(find("install").firstElementChild, t(isBoard() ? "install" : "use.here"));
    find("install").title = isBoard() ? t("install.what") : "";
    find("installed").textContent = "";
  }

  #scores(rows) {
    find("scores").hidden = rows.length === 0;
    find("scores").tBodies[0].replaceChildren(...rows.map(({ measure, before, after }) => {
      const row = made("tr");
      const values = [before, after].map((value) => made("td", measured(measure, value)));
      row.append(made("th", t(`measure.${measure}`), { scope: "row" }), ...values, bars(before, after));
      return row;
    }));
  }

  #commands(next) {
    const { inspect, personalize } = this.#kept ?? {};
    const all = next.length
      ? [[next[0], t(isBoard() ? "cmd.same" : "cmd.put")], [next[1], t("cmd.look")]]
      : [[inspect, t("cmd.inspect")], [personalize, t("cmd.same")]];
    find("commands").parentElement.hidden = !all.some(([text]) => text);
    find("commands").replaceChildren(...all.filter(([text]) => text).map(([text, what]) => command(text, what)));
  }
}
