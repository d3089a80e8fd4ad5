// How the armband sits: what an alignment changed, how to take that back, and whether labels are worse since.

import { ENOUGH } from "./agreement.js";
import { find, write } from "./dom.js";
import { keep, kept } from "./stored.js";
import { capital, fixed, named, t } from "./texts.js";

/** Labels after a change that may belong to before, and the number that is compared, at most. */
const FIRST = 10;
const MOST = 100;
/** Per cent of the labels that must be worse. */
const LESS = 15;

const NONE = { turn: 0, mirrored: false };
const same = (one, other) => one.turn === other.turn && one.mirrored === other.mirrored;
const isNone = (placed) => same(placed, NONE);

/** How the armband sits, in words. */
export function placement({ turn, mirrored }) {
  const turned = turn ? t("turned", { n: turn }) : "";
  const parts = [turned, mirrored ? t("other.arm") : ""].filter(Boolean);
  return parts.join(", ") || t("usual.place");
}

/** What an alignment does, or what came of it, in words. */
export function outcome({ state, gestures }) {
  return state === "waiting" ? t("outcome.waiting", { n: gestures }) : named("outcome", state);
}

/** The newest change, kept by the browser until this tab is closed: a page that is loaded again can take it back. */
const CHANGE = "change of the placement";

/** The placement before the one in force; null if it is unknown. */
function remembered(placed) {
  const change = JSON.parse(kept("tab", CHANGE));
  return change && same(change.placed, placed) ? change.before : null;
}

/** What is in force, and what came of an alignment, as a sentence. */
function said(message) {
  const placed = placement(message);
  switch (message.state) {
    case "waiting":
      return t("said.waiting", { outcome: outcome(message) });
    case "aligned":
      return t("said.aligned", { placement: placed });
    case "set": case "in-force": case "disconnected":
      return isNone(message) ? t("not.aligned") : capital(placed);
    default:
      return capital(isNone(message) ? outcome(message) : `${placed}; ${outcome(message)}`);
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
    find("turn").addEventListener("click", () => say({ do: "turn" }));
    this.clear();
  }

  /** Takes a message about the alignment; an old one is of what was in force before this page was opened. */
  take(message, isOld) {
    const { turn, mirrored, state } = message;
    const placed = { turn, mirrored };
    if (!same(placed, this.#now)) {
      const isKnown = this.#asked || state === "in-force";
      this.#before = isOld ? remembered(placed) : isKnown ? null : this.#now;
      keep("tab", CHANGE, JSON.stringify({ placed, before: this.#before }));
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
    write(find("distance"), distance === null ? "" : fixed(distance / 100, 2));
    write(find("margin"), margin === null ? "" : fixed(margin / 100, 2));
    find("undo").hidden = before === null;
    write(find("undo").firstElementChild, before === null ? "" : t("undo", { placement: placement(before) }));
    find("reset").hidden = isNone(this.#now) || (before !== null && isNone(before));
    this.#worse();
  }

  #worse() {
    const [before, since] = [this.#shareBefore, this.#share()];
    const isWorse = this.#before !== null && before !== null && since !== null && since < before - LESS;
    find("undo").classList.toggle("main", isWorse);
    write(find("worse"), isWorse ? t("worse", { since, before }) : "");
  }
}
