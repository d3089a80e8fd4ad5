// Numbers and texts around the traces. Only what has changed is written to the document.

const ALIGNMENTS = {
  waiting: (found) => `waiting: rest, open the hand wide for a second, rest; ${found} of 2 seen`,
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

const find = (id) => document.getElementById(id);

function write(node, text) {
  if (node.textContent !== text) {
    node.textContent = text;
  }
}

export class Panel {
  source(state, text) {
    const node = find("source");
    node.dataset.state = state;
    write(node.querySelector("span"), text);
  }

  report({ lost, bridged, resets, emitted, instant, is_label: isLabel }) {
    if (isLabel) {
      this.number("delay", `${(emitted - instant) * 5} ms`);
    }
    const plural = resets === 1 ? "" : "s";
    this.number("lost", lost ? `${lost}, ${bridged} bridged, ${resets} reset${plural}` : "0");
  }

  number(id, text) {
    write(find(id), text);
  }

  legend(model) {
    const names = model ? [...model.classes, ...(model.other ? ["other"] : [])] : [];
    const entries = names.map((name) => {
      const entry = document.createElement("span");
      entry.className = name;
      entry.append(document.createElement("i"), name === "other" ? "other movement" : name);
      return entry;
    });
    const none = "no scores: give the board's model with --model FILE";
    find("legend").replaceChildren(...(entries.length ? entries : [none]));
  }

  notice(text) {
    write(find("notice"), text);
  }
}

/** How the armband sits, in words. */
export function placement({ turn, mirrored }) {
  const turned = turn ? `turned by ${turn} place${turn === 1 ? "" : "s"}` : "";
  const parts = [turned, mirrored ? "on the other arm" : ""].filter(Boolean);
  return parts.join(", ") || "as in training";
}

/** What an alignment does, or what came of it, in words. */
export function outcome({ state, gestures }) {
  return (ALIGNMENTS[state] ?? (() => state))(gestures);
}

/** Both. */
export function alignmentText(message) {
  const { distance, margin } = message;
  const quality = distance === null ? "" : ` (distance ${distance / 100}, margin ${margin / 100})`;
  return `${placement(message)}; ${outcome(message)}${quality}`;
}
