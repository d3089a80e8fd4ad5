// Record of a person's sessions, to read and to print: a row each.

import { find, made } from "./dom.js";
import { remark } from "./notes.js";
import { choose, fill, fixed, language, t } from "./texts.js";

const known = (value, digits) => (value === null ? t("unknown") : fixed(value, digits));
const share = (value) => (value === null ? t("unknown") : t("percent", { share: Math.round(100 * value) }));
/** In the reader's own time. */
const date = (began) => new Date(began).toLocaleString(language, { dateStyle: "medium", timeStyle: "short" });

/** Columns: key of the name, and the text of a session. */
const COLUMNS = [
  ["h.date", ({ began }) => date(began)],
  ["h.protocol", ({ protocol, is_synthetic: simulated }) => (simulated ? t("h.simulated", { protocol }) : protocol)],
  ["h.minutes", ({ seconds }) => known(seconds / 60, 1)],
  ["h.gestures", ({ gestures }) => String(gestures)],
  ["h.right", ({ recognised }) => share(recognised)],
  ["h.reaction", ({ reaction, gestures }) => (reaction === null && gestures ? t("h.missed") : known(reaction, 0))],
  ["h.steady", ({ flicker }) => known(flicker, 1)],
  ["h.false", ({ false_activations: rises }) => known(rises, 1)],
  ["h.raised", ({ raised }) => share(raised)],
];

function cell(name, key, text) {
  const own = made(name, text);
  own.dataset.column = t(key);
  return own;
}

function show({ person, model, version, sessions }) {
  find("person").textContent = t("h.person", { name: person });
  find("model").textContent = t("h.model", { model, version });
  const judged = sessions.filter(({ recognised }) => recognised !== null);
  const [first, last] = [judged[0], judged.at(-1)];
  find("trend").textContent = judged.length < 2 ? "" : t("h.trend", {
    n: judged.length, from: share(first.recognised), began: date(first.began), to: share(last.recognised), ended: date(last.began),
  });
  find("state").textContent = sessions.length ? "" : t("h.none");
  const table = find("sessions");
  table.hidden = sessions.length === 0;
  table.tHead.rows[0].replaceChildren(...COLUMNS.map(([key]) => {
    const head = cell("th", key, t(key));
    head.scope = "col";
    return head;
  }));
  table.tBodies[0].replaceChildren(...sessions.flatMap((session) => {
    const row = made("tr");
    row.append(...COLUMNS.map(([key, text]) => cell("td", key, text(session))));
    const notes = session.remarks.map((one) => {
      const line = made("tr", "", { className: "remark" });
      line.append(made("th", t(one.is === "note" ? "notes.label" : "blocks"), { scope: "row" }), made("td", remark(one), { colSpan: COLUMNS.length - 1 }));
      return line;
    });
    return [row, ...notes];
  }));
}

fill();
document.title = `myointent ${t("h.title")}`;
find("print").addEventListener("click", () => print());
// Paper shows what the columns mean.
addEventListener("beforeprint", () => document.querySelectorAll("details").forEach((one) => { one.open = true; }));
find("language").addEventListener("click", choose);
try {
  const answer = await fetch("sessions.json");
  if (!answer.ok) {
    throw new Error(await answer.text());
  }
  show(await answer.json());
} catch (error) {
  find("state").textContent = t("h.failed", { text: error.message });
}
