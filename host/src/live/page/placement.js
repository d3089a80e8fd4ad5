// How the armband sits: what an alignment changed, how to take that back, and whether labels are worse since.

import { alignmentText, placement } from "./panel.js";

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

  /** Takes a message about the alignment. */
  take(message) {
    const { turn, mirrored, state } = message;
    const placed = { turn, mirrored };
    if (!same(placed, this.#now)) {
      // What is in force already was found before this page was opened.
      this.#before = this.#asked || state === "in-force" ? null : this.#now;
      this.#asked = false;
      this.#shareBefore = this.#before && this.#share();
      this.#judged = [];
    }
    this.#now = placed;
    this.#show(alignmentText(message));
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
    this.#show("not aligned");
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

  #show(text) {
    const before = this.#before;
    this.#armband.place(this.#now.turn, this.#now.mirrored, text);
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
