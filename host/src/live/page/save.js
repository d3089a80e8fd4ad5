// What was seen as a csv in ReactEMG's layout, with further columns that readers of that layout ignore.

import { CHANNELS, lastUpTo } from "./seen.js";
import { RATE } from "./clock.js";

const CLASSES = ["relax", "open", "close", "wave-in", "wave-out", "pinch"];

/** The text, and its duration in seconds. Label: -1 where the recording has none, and for every sample of a board. */
export function csv(seen) {
  const channels = Array.from({ length: CHANNELS }, (_, channel) => `emg_${channel}`);
  const rows = [["gt", ...channels, "sample", "label", "valid", "turn", "mirrored", "mark"].join(",")];
  const [first, end] = seen.stretch();
  let mark = seen.marks.findIndex((one) => one.sample >= first);
  for (let sample = first; sample < end; sample += 1) {
    const values = channels.map((_, channel) => seen.value(sample, channel));
    const label = seen.labels[lastUpTo(seen.labels, "from", sample)];
    const texts = [];
    while (mark >= 0 && seen.marks[mark]?.sample <= sample) {
      texts.push(seen.marks[mark].text.replace(/[",\r\n]/g, " "));
      mark += 1;
    }
    rows.push([
      CLASSES.indexOf(seen.truthAt(sample)),
      ...values,
      sample,
      label?.label ?? "",
      label ? Number(label.valid) : "",
      ...seen.placement(sample),
      texts.join("; "),
    ].join(","));
  }
  return { text: `${rows.join("\n")}\n`, seconds: (end - first) / RATE };
}

/** Hands a text to the browser as a file. */
export function download(name, text) {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(new Blob([text], { type: "text/csv" }));
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
}

/** live_20261123_051200.csv */
export function fileName(date) {
  const two = (number) => String(number).padStart(2, "0");
  const day = `${date.getFullYear()}${two(date.getMonth() + 1)}${two(date.getDate())}`;
  return `live_${day}_${two(date.getHours())}${two(date.getMinutes())}${two(date.getSeconds())}.csv`;
}
