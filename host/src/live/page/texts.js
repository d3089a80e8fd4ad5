// Language of the page: the browser's, or the one chosen here. All its texts stand in the tables of the languages.

import { ENGLISH } from "./english.js";
import { ENGLISH_SESSION } from "./english-session.js";
import { GERMAN } from "./german.js";
import { GERMAN_SESSION } from "./german-session.js";

export const TABLES = { en: { ...ENGLISH, ...ENGLISH_SESSION }, de: { ...GERMAN, ...GERMAN_SESSION } };

const CHOSEN = "language";
const own = navigator.languages.map((name) => name.slice(0, 2)).find((name) => name in TABLES);

export const language = localStorage.getItem(CHOSEN) ?? own ?? "en";

/** Text of a key, with its parts filled in; the form before `|` is for a number `n` of one. */
export function t(key, parts = {}) {
  const [one, several] = TABLES[language][key].split("|");
  const text = parts.n === 1 ? one : several ?? one;
  return text.replace(/\{(\w+)\}/g, (_, name) => parts[name]);
}

/** Text of a key, or the name itself if the table does not have it: what another version of the program sends. */
export const named = (kind, name) => (`${kind}.${name}` in TABLES[language] ? t(`${kind}.${name}`) : name);

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
  localStorage.setItem(CHOSEN, language === "en" ? "de" : "en");
  location.reload();
}
