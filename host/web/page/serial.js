// A board, by Web Serial.

const BAUD = 115_200;
/** Bytes that wait while the page stalls: those of five seconds. */
const BUFFER = 1 << 16;
const encoder = new TextEncoder();

export class Board {
  #port;
  #writer;
  #reader = null;
  /** What is sent last. */
  #leave = "";

  constructor(port) {
    this.#port = port;
    this.#writer = port.writable.getWriter();
  }

  static get works() {
    return "serial" in navigator;
  }

  /** Lets the user choose a port, and opens it; fails if none is chosen or it cannot be opened. */
  static async choose() {
    const port = await navigator.serial.requestPort();
    await port.open({ baudRate: BAUD, bufferSize: BUFFER });
    // A board with USB sends once a program is there.
    await port.setSignals({ dataTerminalReady: true });
    return new Board(port);
  }

  /** Passes on what the board sends; calls `gone` once it is unplugged. */
  async run(heard, gone) {
    // Noise ends a reader, and the port has another one; without a board it has none.
    while (this.#port.readable) {
      this.#reader = this.#port.readable.getReader();
      try {
        for (let read = await this.#reader.read(); !read.done; read = await this.#reader.read()) {
          heard(read.value);
        }
        return;
      } catch {
        // The next reader, or none.
      } finally {
        this.#reader.releaseLock();
      }
    }
    gone();
  }

  take({ line, leave }) {
    if (leave) {
      this.#leave = leave;
      return;
    }
    // A board that is unplugged ends the reading.
    this.#writer.write(encoder.encode(line)).catch(() => {});
  }

  async close() {
    try {
      await this.#writer.write(encoder.encode(this.#leave));
      await this.#reader?.cancel();
      this.#writer.releaseLock();
      await this.#port.close();
    } catch {
      // It is unplugged.
    }
  }
}
