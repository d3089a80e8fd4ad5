// Language of the page: the browser's, or the one chosen here. All its texts stand in the tables of the languages.

import { ENGLISH } from "./english.js";
import { ENGLISH_SESSION } from "./english-session.js";
import { GERMAN } from "./german.js";
import { GERMAN_PROGRAM } from "./german-program.js";
import { GERMAN_SESSION } from "./german-session.js";
import { keep, kept } from "./stored.js";

export const TABLES = { en: { ...ENGLISH, ...ENGLISH_SESSION }, de: { ...GERMAN, ...GERMAN_SESSION } };

const CHOSEN = "language";
const own = navigator.languages.map((name) => name.slice(0, 2)).find((name) => name in TABLES);

export const language = kept("always", CHOSEN) ?? own ?? "en";

/** A number with so many digits behind its point, or comma. */
export const fixed = (value, digits) => value.toLocaleString(language, { minimumFractionDigits: digits, maximumFractionDigits: digits, useGrouping: false });

/** Text of a key, with its parts filled in; the form before `|` is for a number `n` of one. */
export function t(key, parts = {}) {
  const [one, several] = TABLES[language][key].split("|");
  const text = parts.n === 1 ? one : several ?? one;
  return text.replace(/\{(\w+)\}/g, (_, name) => (Number.isInteger(parts[name]) || typeof parts[name] !== "number" ? parts[name] : parts[name].toLocaleString(language)));
}

/** Text of a key, or the name itself if the table does not have it: what another version of the program sends. */
export const named = (kind, name) => (`${kind}.${name}` in TABLES[language] ? t(`${kind}.${name}`) : name);

/** Between two sentences. */
const SENTENCE = /(?<=[.?!]) /;

/** What the program says, as a pattern, and in the language of the page; the most specific first. */
const SAID = Object.entries(language === "de" ? GERMAN_PROGRAM : {}).map(([english, own]) => {
  const parts = english.split(/\{\d\}/).map((part) => part.replace(/[.*+?^${}()|[\]\\]/g, "\\$&"));
  return { pattern: new RegExp(`^${parts.join("(.*?)")}$`, "s"), own, length: parts.join("").length, several: SENTENCE.test(english) };
}).sort((one, other) => other.length - one.length);

/** Translation of a sentence, or of several that belong together; null without one. */
function translated(text) {
  const several = SENTENCE.test(text);
  const { pattern, own } = SAID.find((entry) => entry.several >= several && entry.pattern.test(text)) ?? {};
  const parts = pattern?.exec(text);
  return parts ? own.replace(/\{(\d)\}/g, (_, number) => said(parts[number])) : null;
}

/** What the program says, in the language of the page: a text, sentence by sentence; a number; names of classes. */
export function said(text) {
  if (SAID.length === 0) {
    return text;
  }
  const sentences = text.split(SENTENCE);
  const begun = text.endsWith(".") ? translated(text.slice(0, -1)) : null;
  const whole = begun ? `${begun}.` : translated(text);
  if (whole === null && sentences.length > 1) {
    return sentences.map(said).join(" ");
  }
  const number = /^-?\d+\.\d+$/.test(text) ? text.replace(".", ",") : null;
  if (whole === null && text.includes(": ")) {
    return text.split(": ").map(said).join(": ");
  }
  return whole ?? number ?? text.split(", ").map((name) => named("class", name)).join(", ");
}

/** Writes the texts of elements that name them: their content, title and name for a screen reader. */
export function fill() {
  document.documentElement.lang = language;
  for (const node of document.querySelectorAll("[data-text], [data-title], [data-name]")) {
    const { text, title, name } = node.dataset;
    if (text) {
      node.textContent = t(text);
    }
    if (title) {
      node.title = t(title);
    }
    if (name) {
      node.setAttribute("aria-label", t(name));
    }
  }
}

/** Chooses the other language; the page begins anew. */
export function choose() {
  keep("always", CHOSEN, language === "en" ? "de" : "en");
  location.reload();
}
