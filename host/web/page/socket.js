// The websocket of the program that served this page.

import { t } from "./texts.js";

export class Socket {
  #calls;
  #socket = null;

  constructor(calls) {
    this.#calls = calls;
    this.#connect();
  }

  say(message) {
    if (this.#socket.readyState === WebSocket.OPEN) {
      this.#socket.send(JSON.stringify(message));
    }
  }

  #connect() {
    const { opened, take, closed } = this.#calls;
    const address = new URL("socket", location.href);
    address.protocol = "ws:";
    this.#socket = new WebSocket(address);
    this.#socket.onopen = opened;
    this.#socket.onmessage = ({ data }) => take(JSON.parse(data));
    // A program that is started again has the same address, unless that has a token.
    this.#socket.onclose = () => setTimeout(() => this.#connect(), closed(t("source.silent"), [t("empty.gone"), t("empty.again")]));
  }
}
