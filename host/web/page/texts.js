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

/** A text with its parts filled in: `{n}`, or `{n:1}` for a number with one digit behind its point. */
function filled(text, parts) {
  return text.replace(/\{(\w+)(?::(\d))?\}/g, (_, name, digits) => {
    const part = parts[name];
    const isNumber = typeof part === "number";
    return isNumber && digits ? fixed(part, Number(digits)) : isNumber && !Number.isInteger(part) ? part.toLocaleString(language) : part;
  });
}

/** Text of a key, with its parts filled in; the form before `|` is for a number `n` of one. */
export function t(key, parts = {}) {
  const [one, several] = TABLES[language][key].split("|");
  return filled(parts.n === 1 ? one : several ?? one, parts);
}

/** A text that begins with a capital letter. */
export const capital = (text) => `${text[0].toUpperCase()}${text.slice(1)}`;

/** Text of a key, or the name itself if the table does not have it: what another version of the program sends. */
export const named = (kind, name) => (`${kind}.${name}` in TABLES[language] ? t(`${kind}.${name}`) : name);

/** What the program says, by the names of its messages; in English its own words are shown. */
const SAID = language === "de" ? GERMAN_PROGRAM : {};

/** Fields of messages whose values are names of classes. */
const CLASSES = ["class", "classes", "expected", "missing", "recorded"];

/** A value of a message in the language of the page: another message, names in a row, or what has a name in a table. */
function value(field, own) {
  if (Array.isArray(own)) {
    return own.map((one) => value(field, one)).join(own.length === 2 ? SAID.and : ", ") || SAID[`${field}.`];
  }
  if (own?.text) {
    return said(own);
  }
  const table = CLASSES.includes(field) ? "class" : field;
  return typeof own === "string" ? SAID[`${field}.${own}`] ?? named(table, own) : own;
}

/** What the program says, in the language of the page: a message with its English, and a name and values that a language has words for; nothing for null. */
export function said(message) {
  const { text, name, ...values } = message ?? { text: "" };
  const parts = Object.entries(values).map(([field, own]) => [field, value(field, own)]);
  const isWhole = name in SAID && parts.every(([, own]) => own !== null);
  return isWhole ? filled(SAID[name], Object.fromEntries(parts)) : text;
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
