// Fakes of Web Bluetooth and Web Serial, stricter than a browser: whatever a browser may refuse, they refuse.
// A test sets BOARD: { lines, period, identity, calibration }, null for a board that the test plays itself with `written`
// and `hear`; and ARMBAND: { pairs, period }.

const refuse = (name, text) => {
  throw new DOMException(text, name);
};
const needs = (is, name, text) => is || refuse(name, text);
/** A chooser is opened by a user's key or click alone. */
const chosen = () => needs(navigator.userActivation.isActive, "SecurityError", "Must be handling a user gesture");
const later = () => new Promise((done) => setTimeout(done, 1));

// A board: streams its lines once $RAW,on has come, and answers $IDENTIFY.
class Port {
  written = "";
  #controller = null;
  #timer = null;
  #isReady = false;
  /** Its next answers about the calibration; the last one stays. */
  #calibration = BOARD?.calibration.slice(0, 1);
  readable = null;
  writable = null;

  async open({ baudRate }) {
    needs(this.readable === null, "InvalidStateError", "The port is already open");
    needs(baudRate === 115200, "NotSupportedError", "baud rate");
    this.readable = new ReadableStream({ start: (controller) => (this.#controller = controller), cancel: () => clearInterval(this.#timer) });
    this.writable = new WritableStream({ write: (bytes) => this.#command(new TextDecoder().decode(bytes)) });
  }

  async setSignals({ dataTerminalReady }) {
    needs(this.readable, "InvalidStateError", "The port is closed");
    this.#isReady = dataTerminalReady;
  }

  #command(text) {
    this.written += text;
    needs(/^(\$[^\r\n]+\*[0-9A-F]{2}\r\n)+$/.test(text), "DataError", `no command: ${text}`);
    if (BOARD) {
      this.#answer(text);
    }
  }

  #answer(text) {
    if (text.startsWith("$IDENTIFY")) {
      this.hear(BOARD.identity);
    }
    if (text.startsWith("$CALIBRATE")) {
      this.#calibration = { begin: BOARD.calibration.slice(1), forget: BOARD.calibration.slice(0, 1) }[text.slice(11).split("*")[0]] ?? this.#calibration;
      this.hear(this.#calibration.length > 1 ? this.#calibration.shift() : this.#calibration[0]);
    }
    if (text.startsWith("$RAW,on") && this.#timer === null && this.#isReady) {
      let next = 0;
      this.#timer = setInterval(() => {
        this.hear(BOARD.lines[next]);
        next += 1;
        if (next === BOARD.lines.length) {
          clearInterval(this.#timer);
        }
      }, BOARD.period);
    }
    if (text.startsWith("$RAW,off")) {
      clearInterval(this.#timer);
    }
  }

  /** Sends a text, cut where a cable would cut it: anywhere. */
  hear(text) {
    const bytes = new TextEncoder().encode(text);
    const cut = bytes.length >> 1;
    for (const part of [bytes.slice(0, cut), bytes.slice(cut)]) {
      this.#controller.enqueue(part);
    }
  }

  /** The cable is pulled. */
  pull() {
    clearInterval(this.#timer);
    this.readable = null;
    this.#controller.error(new DOMException("The device has been lost", "NetworkError"));
  }

  async close() {
    needs(!this.readable.locked && !this.writable.locked, "TypeError", "a stream is locked");
    this.readable = this.writable = null;
  }
}

// An armband: streams once it is told to, on its four characteristics in turn. Services that nobody asked for are not there.
const uuid = (short) => `d506${short}-a904-deb9-4748-2c7f4a124842`;
const sig = (short) => `0000${short}-0000-1000-8000-00805f9b34fb`;
const SERVICES = {
  [uuid("0001")]: { [uuid("0201")]: [1, 0, 5, 0, 0xb2, 7, 2, 0], [uuid("0401")]: null },
  [uuid("0002")]: { [uuid("0402")]: null },
  [uuid("0005")]: { [uuid("0105")]: null, [uuid("0205")]: null, [uuid("0305")]: null, [uuid("0405")]: null },
  [sig("180f")]: { [sig("2a19")]: [80] },
};
const COMMAND = uuid("0401");
const EMG = ["0105", "0205", "0305", "0405"].map(uuid);
const view = (bytes) => new DataView(Uint8Array.from(bytes, (byte) => byte & 255).buffer);

class Characteristic extends EventTarget {
  value = null;
  isNotifying = false;
  oncharacteristicvaluechanged = null;

  constructor(server, uuid, content) {
    super();
    Object.assign(this, { server, uuid, content });
  }

  async readValue() {
    return this.server.operate(() => {
      needs(this.content, "NotSupportedError", "GATT operation not permitted.");
      this.value = view(this.content);
      return this.value;
    });
  }

  async startNotifications() {
    return this.server.operate(() => {
      needs(!this.content || this.uuid === sig("2a19"), "NotSupportedError", "GATT operation not permitted.");
      this.isNotifying = true;
      return this;
    });
  }

  async writeValueWithResponse(bytes) {
    return this.server.operate(() => {
      needs(this.uuid === COMMAND, "NotSupportedError", "GATT operation not permitted.");
      // Never sleep, or set mode: filtered EMG, and once it streams with movement.
      const command = [...bytes].join();
      needs(["9,1,1", "1,3,2,0,0", "1,3,2,1,0"].includes(command), "NotSupportedError", `command ${command}`);
      if (command !== "9,1,1") {
        this.server.stream(command === "1,3,2,1,0");
      }
    });
  }

  notify(bytes) {
    if (this.isNotifying) {
      this.value = view(bytes);
      this.oncharacteristicvaluechanged?.({ target: this });
    }
  }
}

class Server {
  connected = false;
  connections = 0;
  #busy = false;
  #timer = null;
  #moves = false;
  #found = [];
  #next = 0;

  constructor(device) {
    this.device = device;
  }

  async connect() {
    await later();
    this.connected = true;
    this.connections += 1;
    return this;
  }

  /** The link is lost, or closed. */
  disconnect() {
    if (this.connected) {
      this.connected = false;
      clearInterval(this.#timer);
      this.#timer = null;
      this.#found = [];
      this.device.dispatchEvent(new Event("gattserverdisconnected"));
    }
  }

  async operate(act) {
    needs(this.connected, "NetworkError", "GATT Server is disconnected.");
    needs(!this.#busy, "NetworkError", "GATT operation already in progress.");
    this.#busy = true;
    await later();
    this.#busy = false;
    needs(this.connected, "NetworkError", "GATT Server disconnected.");
    return act();
  }

  async getPrimaryServices() {
    return this.operate(() => this.device.allowed.map((service) => ({
      getCharacteristics: () => this.operate(() => Object.entries(SERVICES[service]).map(([uuid, content]) => {
        const one = new Characteristic(this, uuid, content);
        this.#found.push(one);
        return one;
      })),
    })));
  }

  stream(withMovement) {
    this.#moves = withMovement;
    if (this.#timer !== null) {
      return;
    }
    let lane = 0;
    let due = performance.now();
    // An armband keeps its pace: what a busy machine delays comes in a burst.
    this.#timer = setInterval(() => {
      for (; due <= performance.now(); due += ARMBAND.period) {
        const pair = ARMBAND.pairs[this.#next % ARMBAND.pairs.length];
        this.#found.find(({ uuid }) => uuid === EMG[lane])?.notify(pair);
        this.#next += 1;
        const movement = [...window.pose, 0, 0, 2048, 0, 0, 0].flatMap((value) => [value, value >> 8]);
        this.#found.find(({ uuid: own }) => this.#moves && this.#next % 2 && own === uuid("0402"))?.notify(movement);
        lane = (lane + 1) % EMG.length;
      }
    }, ARMBAND.period);
  }
}

class Device extends EventTarget {
  name = "Simulated Myo";
  gatt = new Server(this);

  constructor(allowed) {
    super();
    this.allowed = allowed;
  }
}

/** Quaternion of the armband, as it sends one. */
window.pose = [16384, 0, 0, 0];

const give = (name, value) => Object.defineProperty(navigator, name, { value, configurable: true });
give("serial", {
  async requestPort() {
    chosen();
    window.port = new Port();
    return window.port;
  },
});
give("bluetooth", {
  async requestDevice({ filters, optionalServices = [] }) {
    chosen();
    needs(filters.some(({ services }) => services.includes(uuid("0001"))), "NotFoundError", "User cancelled the requestDevice() chooser.");
    const allowed = [...filters.flatMap(({ services }) => services), ...optionalServices];
    window.device = new Device(Object.keys(SERVICES).filter((service) => allowed.includes(service)));
    return window.device;
  },
});
