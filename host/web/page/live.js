// The page: takes messages from the program, draws, and passes on what the viewer asks for.

import { Agreement } from "./agreement.js";
import { Arm } from "./arm.js";
import { Armband } from "./armband.js";
import { Blocks } from "./blocks.js";
import { find } from "./dom.js";
import { Empty } from "./empty.js";
import "./help.js";
import { Calibration } from "./calibration.js";
import { CHANNELS, CLASSES, SampleHistory } from "./history.js";
import { Clock, RATE } from "./clock.js";
import { connect } from "./link.js";
import { Notes } from "./notes.js";
import { Now } from "./now.js";
import { Panel } from "./panel.js";
import { Placement } from "./placement.js";
import { Rates } from "./rates.js";
import { installation } from "./result.js";
import { Session } from "./session.js";
import { download, save } from "./save.js";
import { Steps } from "./steps.js";
import { keep, kept } from "./stored.js";
import { choose, fill, named, said, t } from "./texts.js";
import { Traces } from "./traces.js";
import { Wearer } from "./wearer.js";

// Before anything is shown.
fill();
const clock = new Clock();
const history = new SampleHistory();
const now = new Now();
const panel = new Panel();
const rates = new Rates();
const traces = new Traces(find("traces"));
const calibration = new Calibration(say);
const blocks = new Blocks(say);
const notes = new Notes(say);
const arm = new Arm();
const armband = new Armband(find("armband"));
const agreement = new Agreement();
const placement = new Placement(armband, say);
const empty = new Empty();
const session = new Session(say);
const steps = new Steps(say);
const wearer = new Wearer();
const still = matchMedia("(prefers-reduced-motion: reduce)");

/** Time for which a notice of something that is over stays, in ms. */
const PASSING = 8000;

let link = null;
let ended = false;
let connected = false;
let newest = null;
/** The last report of the stream; null without one, and then why there is none. */
let report = null;
let noReport = t("no.label.yet");
let paused = null;
let held = null;
let marks = 0;
/** Whether this page has asked for files. */
let saves = false;
let aligning = false;
let skipped = 0;
let dropped = 0;
let shown = 0;
/** Right edge of the picture, in samples. */
let drawn = null;

const TAKE = {
  hello(message) {
    clock.hello(message.now);
    simulated(false);
    session.hello(message);
    notes.take({ remarks: [] });
    traces.scores = !message.record;
  },
  pong: (message) => clock.pong(message.sent, message.now),
  source(message) {
    const name = t(`source.${message.kind}`, { name: named("place", message.name) });
    connected = message.connected;
    panel.source(connected ? "connected" : "lost", message.detail ? `${name}: ${said(message.detail)}` : name);
    document.body.dataset.kind = message.kind;
    if (message.kind === "demo") {
      simulated(true);
    }
    find("align").disabled = find("calibrate").disabled = find("play").disabled = !connected;
    if (!connected) {
      noStream();
    }
  },
  model(message) {
    traces.model = message;
    history.classes = message.classes;
    panel.legend(message);
  },
  board(message) {
    simulated(message.image === "simulated");
    panel.number("board", `${named("place", message.image)}, ${message.version}`);
    panel.number("address", message.armband ?? t("none.connected"));
    panel.number("battery", message.battery === null ? "–" : `${message.battery} %`);
  },
  counts(message) {
    const sum = message.packets_dropped + message.lines_dropped + message.emg_dropped;
    if (sum !== dropped) {
      dropped = sum;
      panel.notice(sum ? t("dropped", { n: sum }) : "");
    }
  },
  line({ damaged, missing, samples }) {
    panel.number("line", t("line.lost", { samples, lines: missing + damaged }));
  },
  electrodes(message) {
    armband.electrodes(message);
    panel.strengths(message);
    const parts = message.faults.map((fault, at) => fault && t(`fault.${fault}`, { number: at + 1 }));
    panel.number("electrodes", parts.filter(Boolean).join(" "));
  },
  samples(message) {
    const end = message.first + message.emg.length;
    history.samples(message.first, message.emg, message.truth);
    find("mark").disabled = find("save").disabled = false;
    clock.samples(end, message.at);
    rates.samples(message.at, message.emg.length);
  },
  report(message, isOld) {
    if (!traces.model && !find("legend").hasChildNodes()) {
      panel.legend(null);
    }
    newest = message.is_label && message.valid ? message : message.is_label ? newest : null;
    report = message;
    history.report(message);
    panel.report(message);
    panel.strength(message.strength);
    if (!isOld) {
      count(message);
    }
  },
  scores: (message) => history.scores.push(message),
  alignment(message, isOld) {
    const placed = message.turn + 8 * message.mirrored;
    if (placed !== history.placed) {
      counted();
    }
    history.placed = placed;
    placement.take(message, isOld);
    aligns(message.state === "waiting");
  },
  calibration(message) {
    calibration.take(message);
    if (message.state === "done") {
      counted();
    }
    find("play").disabled = !connected || calibration.isRunning;
  },
  imu: (message) => arm.take(message.quaternion),
  blocks: (message) => blocks.take(message),
  remarks: (message) => notes.take(message),
  file({ name, content }) {
    // All viewers of a program get it, and one has asked.
    if (saves || find("program")) {
      download(name, Uint8Array.from(content, (letter) => letter.charCodeAt(0)));
    }
  },
  mark: ({ sample, text }) => history.marks.push({ sample, text: named("mark", text) }),
  session(message) {
    history.cue(message.from ?? history.end ?? 0, message.cue);
    if (message.phase === "waiting") {
      counted();
    }
    session.show(message);
    if (session.isRunning && paused !== null) {
      actions.pause();
    }
  },
  lead: (message) => session.lead(message),
  kept: (message) => session.kept(message),
  tuning: (message) => session.tuning(message),
  installing(message) {
    session.installing(message);
    const { state, blocks, of } = message;
    if (state === "done") {
      counted();
    }
    find("onto-board").hidden = state !== "running";
    find("onto-board").max = of || 1;
    find("onto-board").value = blocks;
    panel.notice(installation(message).join(" "), state === "running" ? undefined : PASSING);
  },
  comment: (message) => panel.number("comment", said(message)),
  refused: (message) => panel.notice(t("refused", { text: said(message) }), PASSING),
  skipped(message) {
    skipped += message.messages;
    panel.number("skipped", t("skipped", { n: skipped }));
  },
  end() {
    ended = true;
    lost(t("source.ended"), [t("empty.ended"), t("empty.again")]);
  },
};

/** Marks the page while the arm is simulated. Firmware on a PC turns its own arm, so the button is hidden. */
function simulated(is) {
  document.body.toggleAttribute("data-simulated", is);
  find("turn").hidden = !is || (document.body.dataset.kind === "port" && !find("program"));
}

function lost(text, advice) {
  connected = false;
  empty.gone(advice);
  panel.source("lost", text);
  // A session that was led is over: another source may be chosen.
  find("sources").inert = false;
  find("align").disabled = find("calibrate").disabled = find("play").disabled = find("onto-board").hidden = true;
  noStream();
}

function noStream() {
  newest = report = null;
  noReport = t("no.stream");
  history.placed = 0;
  TAKE.electrodes({ faults: new Array(CHANNELS).fill(null), times: null });
  placement.clear();
  calibration.take(null);
  blocks.take(null);
  arm.take(null);
  aligns(false);
}

/** Begins the count of labels as asked anew: they are of another session, placement, calibration or model. */
function counted() {
  agreement.clear();
  now.share(agreement);
}

/** Counts whether a label is what was asked for. */
function count(message) {
  if (message.is_label && message.valid) {
    const isRight = agreement.take(history, message);
    if (isRight !== null) {
      placement.judged(isRight);
    }
    now.share(agreement);
  }
}

function aligns(waiting) {
  aligning = waiting;
  find("align").setAttribute("aria-pressed", String(waiting));
  find("align").firstElementChild.textContent = t(waiting ? "align.stop" : "align");
}

/** Another stream begins, in place of the one before. */
function begun() {
  clock.forget();
  history.clear();
  agreement.clear();
  now.share(agreement);
  noStream();
  traces.model = null;
  history.classes = CLASSES;
  find("legend").replaceChildren();
}

function opened() {
  ended = false;
  ping();
}

function take(messages) {
  // The first ones say what is known.
  const isOld = messages[0]?.type === "hello";
  for (const message of messages) {
    TAKE[message.type]?.(message, isOld);
    steps.take(message);
    empty.take(message);
  }
}

/** The link is lost; returns the ms until it is tried again. */
function closed(text, advice) {
  if (!ended) {
    lost(text, advice);
  }
  return ended ? 3000 : 1000;
}

function say(message) {
  saves ||= message.wish === "save";
  link?.say(message);
}

function ping() {
  for (const wait of [0, 50, 100, 150]) {
    setTimeout(() => say({ do: "ping", sent: performance.now() }), wait);
  }
}

const actions = {
  pause() {
    paused = paused === null ? edge() : null;
    held = newest;
    find("pause").setAttribute("aria-pressed", String(paused !== null));
    find("pause").firstElementChild.textContent = t(paused === null ? "pause" : "resume");
    panel.notice(paused === null ? "" : t("paused"));
  },
  mark() {
    if (history.end !== null) {
      marks += 1;
      const sample = Math.max(0, Math.round(paused ?? history.end - 1));
      say({ do: "mark", sample, text: t("mark.number", { n: marks }) });
    }
  },
  save() {
    panel.notice(save(history, "simulated" in document.body.dataset), PASSING);
  },
  align: () => say({ do: aligning ? "cancel" : "align" }),
  language: choose,
};

for (const [id, action] of Object.entries(actions)) {
  find(id).addEventListener("click", action);
}

/** Settings that the browser keeps: keys of a single letter or digit, which speech input types (WCAG 2.1.4); the hand that is drawn. */
const SETTINGS = { letters: ["on", "off"], drawn: ["right", "left"] };

for (const [name, [first, other]] of Object.entries(SETTINGS)) {
  const set = (value) => {
    document.body.dataset[name] = value;
    find(name).textContent = t(`${name}.${value}`);
    keep("always", name, value);
  };
  find(name).addEventListener("click", () => set(document.body.dataset[name] === first ? other : first));
  set(kept("always", name) === other ? other : first);
}

addEventListener("keydown", (event) => {
  if (event.target.closest?.("#recording,input") || document.body.dataset.letters === "off" && /^[a-z0-9]$/i.test(event.key)) {
    return;
  }
  if (event.ctrlKey || event.metaKey || event.altKey || event.repeat && event.key === " ") {
    return;
  }
  if (session.key(event)) {
    event.preventDefault();
    return;
  }
  if (session.isAsking) {
    return;
  }
  const keys = { " ": "pause", m: "mark", s: "save", a: "align", c: "calibrate", p: "play", u: "undo", w: "wearer" };
  const id = keys[event.key.toLowerCase()];
  if (id && !(event.key === " " && event.target instanceof HTMLButtonElement)) {
    event.preventDefault();
    if (!find(id).hidden) {
      find(id).click();
    }
  }
  if (paused !== null && (event.key === "ArrowLeft" || event.key === "ArrowRight")) {
    event.preventDefault();
    const step = event.key === "ArrowLeft" ? -RATE / 2 : RATE / 2;
    paused = Math.min(history.end ?? 0, Math.max(history.first, paused + step));
    held = null;
  }
});

/** Position of the stream, which moves evenly. */
function position() {
  const end = history.end ?? 0;
  return Math.min(end, clock.position() ?? end);
}

/** Where the picture ends: with the stream; without motion in steps of a second. */
function edge() {
  return still.matches ? Math.floor(position() / RATE) * RATE : position();
}

function frame() {
  session.frame(position());
  calibration.frame();
  blocks.frame();
  const [at, label] = paused === null ? [(history.end ?? 1) - 1, report] : [paused, history.labelAt(paused)];
  now.show(history, at, label, noReport, connected || paused !== null, traces.model?.other && history.isOther(at));
  wearer.show(now.label, now.judged, aligning);
  const to = paused ?? edge();
  // Without motion the picture stands until the next second.
  if (!still.matches || to !== drawn || traces.isStale) {
    traces.draw(history, to, paused === null ? newest : held);
    if (still.matches) {
      activity();
    }
    drawn = to;
  }
  // Of what is drawn for the first time: from its arrival at the program to the picture.
  const end = Math.min(history.end ?? 0, edge());
  if (paused === null && connected && end > shown) {
    rates.drawn(clock.age(end));
  }
  shown = end;
  requestAnimationFrame(frame);
}

function numbers() {
  empty.show();
  const latency = rates.latency();
  if (latency !== null) {
    panel.number("latency", latency);
  }
  panel.number("rate", rates.perSecond(clock.now()));
}

/** Bars of the electrodes. */
function activity() {
  const end = history.end ?? 0;
  const levels = new Array(CHANNELS).fill(0);
  const from = Math.max(history.first, end - RATE / 4);
  for (let sample = from; sample < end; sample += 1) {
    for (let channel = 0; channel < CHANNELS; channel += 1) {
      levels[channel] += Math.abs(history.value(sample, channel)) / (end - from) / 40;
    }
  }
  armband.activity(levels);
}

numbers();
setInterval(numbers, 1000);
setInterval(() => still.matches || activity(), 100);
setInterval(() => now.speak(), 2000);
setInterval(ping, 10_000);
link = connect({ begun, opened, take, closed });
requestAnimationFrame(frame);
