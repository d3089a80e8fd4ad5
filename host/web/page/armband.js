// Placement of the armband: a section of the forearm with the model's eight places round it, and which electrode is on each.

import { CHANNELS } from "./history.js";

const SVG = "http://www.w3.org/2000/svg";
const [WIDE, HIGH] = [74, 68];

/** Times its rest below which an electrode is weak. */
export const WEAK = 2;

function element(parent, name, attributes, text) {
  const made = document.createElementNS(SVG, name);
  for (const [key, value] of Object.entries(attributes)) {
    made.setAttribute(key, value);
  }
  made.textContent = text ?? "";
  parent.append(made);
  return made;
}

/** Angle of a place, the first at the top, then clockwise; from which end of the arm one looks is not known. */
const angle = (place) => (place / CHANNELS) * 2 * Math.PI - Math.PI / 2;

/** The armband's electrode on a place of the model: shared/src/stream/alignment/placement.rs. */
export function electrodeAt(place, turn, mirrored) {
  return (mirrored ? turn + CHANNELS - place : turn + place) % CHANNELS;
}

export class Armband {
  #pods = [];
  #arrow;
  #tip;
  #turn = 0;
  #mirrored = false;
  #faults = new Array(CHANNELS).fill(null);
  #times = null;

  constructor(svg) {
    element(svg, "ellipse", { class: "arm", rx: WIDE - 22, ry: HIGH - 20 });
    element(svg, "circle", { class: "arm", cx: -13, cy: 4, r: 8 });
    element(svg, "circle", { class: "arm", cx: 14, cy: 6, r: 10 });
    this.#arrow = element(svg, "path", { d: "" });
    this.#tip = element(svg, "path", { class: "tip", d: "" });
    for (let place = 0; place < CHANNELS; place += 1) {
      const at = angle(place);
      const [x, y] = [WIDE * Math.cos(at), HIGH * Math.sin(at)];
      const group = element(svg, "g", { transform: `translate(${x} ${y})` });
      const turned = element(group, "g", { transform: `rotate(${(at * 180) / Math.PI + 90})` });
      const pod = element(turned, "rect", { class: "pod", x: -20, y: -13, width: 40, height: 26, rx: 6 });
      const activity = element(turned, "rect", { class: "activity", x: -17, y: 8, width: 34, height: 3.4, rx: 1.7 });
      const number = element(group, "text", {}, String(place + 1));
      const [u, v] = [(WIDE + 25) * Math.cos(at), (HIGH + 25) * Math.sin(at)];
      const outside = element(svg, "text", { class: "place", x: u, y: v }, String(place + 1));
      const times = element(svg, "text", { class: "times", x: (WIDE - 35) * Math.cos(at), y: (HIGH - 31) * Math.sin(at) });
      this.#pods.push({ pod, activity, number, times, outside });
    }
  }

  /** Electrode numbers by the alignment in force. */
  place(turn, mirrored) {
    [this.#turn, this.#mirrored] = [turn, mirrored];
    this.#pods.forEach((pod, place) => {
      pod.number.textContent = String(electrodeAt(place, turn, mirrored) + 1);
      // As in training, both numbers are the same.
      pod.outside.setAttribute("visibility", turn || mirrored ? "visible" : "hidden");
    });
    this.#mark();
    this.#draw(turn, mirrored);
  }

  // From the model's first place to where the armband's first electrode is.
  #draw(turn, mirrored) {
    const places = mirrored ? turn : (CHANNELS - turn) % CHANNELS;
    const shorter = places > CHANNELS / 2 ? places - CHANNELS : places;
    if (shorter === 0) {
      this.#arrow.setAttribute("d", "");
      this.#tip.setAttribute("d", "");
      return;
    }
    const point = (at, scale) => [(WIDE - scale) * Math.cos(at), (HIGH - scale) * Math.sin(at)];
    const sweep = shorter > 0 ? 1 : 0;
    const end = angle(shorter) - (sweep ? 0.16 : -0.16);
    const [from, to] = [point(angle(0), 54), point(end, 54)];
    this.#arrow.setAttribute("d", `M${from} A${WIDE - 54} ${HIGH - 54} 0 0 ${sweep} ${to}`);
    const [inner, outer, front] = [point(end, 59), point(end, 49), point(angle(shorter), 54)];
    this.#tip.setAttribute("d", `M${inner} L${outer} L${front} Z`);
  }

  /** Marks the fault of each electrode, null without one, and shows how many times its rest it has reached, null before the hand was moved. */
  electrodes({ faults, times }) {
    [this.#faults, this.#times] = [faults, times];
    this.#mark();
  }

  #mark() {
    this.#pods.forEach(({ pod, times }, place) => {
      const electrode = electrodeAt(place, this.#turn, this.#mirrored);
      const isFaulty = this.#faults[electrode] !== null;
      const own = isFaulty ? undefined : this.#times?.[electrode];
      pod.classList.toggle("fault", isFaulty);
      pod.classList.toggle("weak", own < WEAK);
      times.textContent = own === undefined ? "" : `×${own}`;
    });
  }

  /** Mean |x| of each of the armband's electrodes, 0 to 1. */
  activity(levels) {
    this.#pods.forEach((pod, place) => {
      const level = Math.min(1, levels[electrodeAt(place, this.#turn, this.#mirrored)]);
      pod.activity.setAttribute("width", (34 * level).toFixed(1));
      pod.activity.setAttribute("x", (-17 * level).toFixed(1));
    });
  }
}
