// Line drawings of the gestures. A hand is a few round strokes: each layer is drawn as ink, and again a little thinner in the
// colour of the ground, so that strokes of one layer melt into one outline and later layers lie in front. The hands are left ones:
// the style sheet mirrors them for a right hand.

import { named } from "./texts.js";

const OUTLINE = 2.6;
const NAMESPACE = "http://www.w3.org/2000/svg";

const ARM = ["M60 128V92", 27];

/** A loose hand whose forearm turns. */
const TURNED = [[["M60 128V92", 27], ["M60 84V72", 38], ["M49 66L46 26", 10.5], ["M57 64L56 20", 11], ["M65.500 64L67 22", 11], ["M74 68L78 32", 10], ["M47 82Q34 74 29 56", 11.5]]];

/** Layers of [path, width]; lines are thin strokes on top, arrows show where the hand goes. */
const HANDS = {
  relax: {
    layers: [
      [["M68 57Q92 60 99 84", 10]],
      [["M-8 46L44 48", 27], ["M44 49L66 57", 25], ["M70 60Q88 66 91 90", 10], ["M66 64Q79 72 81 93", 10]],
      [["M52 57Q62 69 67 86", 10.5]],
    ],
    lines: [],
  },
  open: {
    layers: [
      [ARM, ["M60 88V76", 42], ["M47 72L33 27", 11], ["M56 68L51 15", 11.5], ["M66 68L70 17", 11.5], ["M75 73L89 32", 10.5], ["M48 88Q30 80 17 62", 12]],
    ],
    lines: ["M47 96Q57 92 57 78", "M62 79Q71 82 76 78"],
  },
  close: {
    box: "8 24 102 102",
    layers: [
      [ARM, ["M58 80H66", 40], ["M52 66H72", 26]],
      [["M80 60V78", 12]],
      [["M69.500 54V79", 12.5]],
      [["M58 52V79", 12.5]],
      [["M46.500 55V79", 12.5]],
      [["M44 92Q56 93 69 86", 12.5]],
    ],
    lines: [],
  },
  "wave-in": {
    layers: [
      [["M-8 42H48", 27], ["M52 46L66 68", 25], ["M70 70L80 106", 10], ["M61 72L70 108", 11]],
      [["M53 55Q50 71 54 83", 10.5]],
    ],
    lines: [],
    arrow: ["M84 30Q108 48 108 80", "M101 74L108.500 84L115 73"],
  },
  "wave-out": {
    layers: [
      [["M-8 82H48", 27], ["M52 78L64 56", 25], ["M60 52L66 14", 10], ["M69 56L77 18", 11]],
      [["M58 84Q72 86 82 76", 10.5]],
    ],
    lines: [],
    arrow: ["M92 92Q110 76 108 44", "M100.500 50L107.500 40L115 49"],
  },
  pinch: {
    layers: [
      [ARM, ["M60 88V76", 42], ["M58 68L58 20", 11.5], ["M67 69L77 25", 11.5], ["M75 75L94 41", 10.5], ["M47 70Q42 38 24 50", 11], ["M48 90Q20 88 19 61", 12]],
    ],
    lines: ["M64 80Q72 83 77 79"],
  },
  point: {
    layers: [
      [ARM, ["M58 82H66", 38], ["M50 66L46 16", 12]],
      [["M81 66V80", 11]],
      [["M71.500 62V80", 12]],
      [["M60.500 61V80", 12]],
      [["M44 92Q56 94 70 86", 12.5]],
    ],
    lines: [],
  },
  "two-fingers": {
    layers: [
      [ARM, ["M58 82H66", 38], ["M49 66L37 20", 11.5], ["M60 66L66 15", 12]],
      [["M81 66V80", 11]],
      [["M71.500 62V80", 12]],
      [["M44 92Q56 94 72 86", 12.5]],
    ],
    lines: [],
  },
  "thumb-up": {
    layers: [
      [["M-8 84H40", 27], ["M48 84H58", 40]],
      [["M50 66L54 24", 13.5]],
      [["M56 102H76", 11]],
      [["M56 91.500H80", 12]],
      [["M56 80H82", 12]],
      [["M56 68H80", 12]],
    ],
    lines: [],
  },
  supination: {
    layers: TURNED,
    lines: [],
    arrow: ["M96 106Q60 124 26 104", "M37 101L25 103.500L31 114"],
  },
  pronation: {
    layers: TURNED,
    lines: [],
    arrow: ["M24 106Q60 124 94 104", "M83 101L95 103.500L89 114"],
  },
  other: {
    layers: [
      [["M-8 84H40", 27], ["M44 84L62 80", 27], ["M66 92Q80 96 88 92", 10]],
      [["M70 58H92V92H70ZM80 64V86", 18]],
      [["M60 68Q82 66 90 70", 10.5], ["M60 78Q82 77 91 81", 10.5], ["M60 88Q80 88 88 91", 10.5]],
    ],
    lines: ["M74 38Q78 32 74 26", "M86 38Q90 32 86 26"],
  },
};

function node(name, attributes) {
  const made = document.createElementNS(NAMESPACE, name);
  for (const [key, value] of Object.entries(attributes)) {
    made.setAttribute(key, value);
  }
  return made;
}

/** Draws a gesture into an svg element; an empty picture without one. */
export function draw(svg, name) {
  if (svg.dataset.gesture === (name ?? "")) {
    return;
  }
  svg.dataset.gesture = name ?? "";
  const hand = HANDS[name];
  if (!hand) {
    svg.replaceChildren();
    return;
  }
  svg.setAttribute("viewBox", hand.box ?? "0 0 120 120");
  const parts = [];
  for (const layer of hand.layers) {
    for (const [d, width] of layer) {
      parts.push(node("path", { d, class: "ink", "stroke-width": width + OUTLINE }));
    }
    for (const [d, width] of layer) {
      parts.push(node("path", { d, class: "skin", "stroke-width": width - OUTLINE }));
    }
  }
  parts.push(...hand.lines.map((d) => node("path", { d, class: "crease" })));
  parts.push(...(hand.arrow ?? []).map((d) => node("path", { d, class: "arrow" })));
  svg.replaceChildren(...parts);
}

/** What to do, in words. */
export function words(name) {
  return named("do", name);
}
