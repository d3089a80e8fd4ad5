// Where the messages come from: the program inside this page, or the one that served it.

import { find } from "./dom.js";
import { Socket } from "./socket.js";
import { Tab } from "./tab.js";

/**
 * The link to the stream. It calls `begun()` before another stream, `opened()`, `take(messages)`, and `closed(text, [title,
 * step])`, which returns the ms until it tries again; `say(message)` asks for something.
 */
export const connect = (calls) => (find("program") ? new Tab(calls) : new Socket(calls));
