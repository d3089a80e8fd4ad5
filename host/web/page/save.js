// Saves a history as a csv file.

import { made } from "./dom.js";
import { csv } from "./history.js";
import { fixed, t } from "./texts.js";

/** Hands the history to the browser as a file, whose name tells a simulated arm. Returns what was saved, in words. */
export function save(history, isSimulated) {
  const { text, seconds } = csv(history);
  const name = fileName(isSimulated ? "simulated" : "live", new Date());
  download(name, text);
  const key = history.stretch()[0] > history.first ? "saved.gap" : "saved";
  return t(key, { seconds: fixed(seconds, 1), name });
}

/** Hands a file to the user. */
export function download(name, content) {
  const link = made("a", "", { href: URL.createObjectURL(new Blob([content])), download: name });
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
}

/** live_20261123_051200.csv */
function fileName(what, date) {
  const two = (number) => String(number).padStart(2, "0");
  const day = `${date.getFullYear()}${two(date.getMonth() + 1)}${two(date.getDate())}`;
  return `${what}_${day}_${two(date.getHours())}${two(date.getMinutes())}${two(date.getSeconds())}.csv`;
}
