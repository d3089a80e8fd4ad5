// How the armband sits: what an alignment changed, how to take that back, and whether labels are worse since.

const OUTCOMES = {
  waiting: (found) => `rest, open the hand wide for a second, rest; ${found} of 2 openings seen`,
  aligned: () => "aligned",
  "in-force": () => "in force",
  "poor-distance": () => "not aligned: those were no openings of the hand; nothing changed",
  "poor-margin": () => "not aligned: two placements look alike; nothing changed",
  timeout: () => "not aligned: no two openings of the hand in 30 s; nothing changed",
  cancelled: () => "alignment ended; nothing changed",
  disconnected: () => "not aligned since the armband was connected",
  unavailable: () => "this model has no template, so it cannot be aligned",
  set: () => "set",
};

/** Labels in gestures that are compared, at least: 3 s of them. The first ones after a change may belong to before. */
const ENOUGH = 30;
const FIRST = 10;
const MOST = 100;
/** Per cent of the labels that must be worse. */
const LESS = 15;

const find = (id) => document.getElementById(id);

function write(node, text) {
  if (node.textContent !== text) {
    node.textContent = text;
  }
}

const NONE = { turn: 0, mirrored: false };
const same = (one, other) => one.turn === other.turn && one.mirrored === other.mirrored;
const isNone = (placed) => same(placed, NONE);

/** How the armband sits, in words. */
export function placement({ turn, mirrored }) {
  const turned = turn ? `turned by ${turn} place${turn === 1 ? "" : "s"}` : "";
  const parts = [turned, mirrored ? "on the other arm" : ""].filter(Boolean);
  return parts.join(", ") || "as in training";
}

/** What an alignment does, or what came of it, in words. */
export function outcome({ state, gestures }) {
  return (OUTCOMES[state] ?? (() => state))(gestures);
}

const sentence = (text) => `${text[0].toUpperCase()}${text.slice(1)}`;

/** What is in force, and what came of an alignment, as a sentence. */
function said(message) {
  const placed = isNone(message) ? null : placement(message);
  switch (message.state) {
    case "waiting":
      return `Aligning: ${outcome(message)}`;
    case "aligned":
      return `Aligned: ${placed ?? "it sits as in training"}`;
    case "set": case "in-force": case "disconnected":
      return placed ? `In force: ${placed}` : "Not aligned";
    default:
      return sentence(placed ? `${placed}; ${outcome(message)}` : outcome(message));
  }
}

export class Placement {
  #armband;
  #say;
  #now = NONE;
  /** Placement before the newest change; null if it is unknown or was asked for. */
  #before = null;
  /** Whether this page has asked for the next change. */
  #asked = false;
  /** Whether the newest labels in gestures were as asked, and their share in per cent before the change. */
  #judged = [];
  #shareBefore = null;

  constructor(armband, say) {
    this.#armband = armband;
    this.#say = say;
    find("undo").addEventListener("click", () => this.#put(this.#before));
    find("reset").addEventListener("click", () => this.#put(NONE));
    this.clear();
  }

  /** Takes a message about the alignment; an old one is of what was in force before this page was opened. */
  take(message, isOld) {
    const { turn, mirrored, state } = message;
    const placed = { turn, mirrored };
    if (!same(placed, this.#now)) {
      this.#before = this.#asked || isOld || state === "in-force" ? null : this.#now;
      this.#asked = false;
      this.#shareBefore = this.#before && this.#share();
      this.#judged = [];
    }
    this.#now = placed;
    this.#show(message);
  }

  /** Takes whether a label in a gesture is the one asked for. */
  judged(isRight) {
    this.#judged.push(isRight);
    if (this.#judged.length > MOST) {
      this.#judged.shift();
    }
    this.#worse();
  }

  /** Nothing is known: there is no stream. */
  clear() {
    this.#now = NONE;
    this.#before = this.#shareBefore = null;
    this.#asked = false;
    this.#judged = [];
    this.#show({ ...NONE, state: "disconnected", distance: null, margin: null });
  }

  #put(placed) {
    if (placed) {
      this.#asked = true;
      this.#say({ do: "place", ...placed });
    }
  }

  #share() {
    const counted = this.#judged.slice(FIRST);
    return counted.length < ENOUGH ? null : Math.round((100 * counted.filter(Boolean).length) / counted.length);
  }

  #show(message) {
    const before = this.#before;
    this.#armband.place(this.#now.turn, this.#now.mirrored);
    write(find("placement"), said(message));
    const { distance, margin } = message;
    find("fit").hidden = distance === null;
    write(find("distance"), distance === null ? "" : `${distance / 100}`);
    write(find("margin"), margin === null ? "" : `${margin / 100}`);
    find("undo").hidden = before === null;
    write(find("undo").firstElementChild, before === null ? "" : `Undo: ${placement(before)}`);
    find("reset").hidden = isNone(this.#now) || (before !== null && isNone(before));
    this.#worse();
  }

  #worse() {
    const [before, since] = [this.#shareBefore, this.#share()];
    const isWorse = this.#before !== null && before !== null && since !== null && since < before - LESS;
    find("undo").classList.toggle("main", isWorse);
    write(find("worse"), isWorse ? `Since then ${since} % of the gestures are labelled as asked, ${before} % before.` : "");
  }
}
