// An armband, by Web Bluetooth: carries out the actions of the session, and decides nothing.

import { Arrival } from "./arrival.js";

const CONTROL = "d5060001-a904-deb9-4748-2c7f4a124842";
const EMG = "d5060005-a904-deb9-4748-2c7f4a124842";
const IMU = "d5060002-a904-deb9-4748-2c7f4a124842";
const BATTERY = "0000180f-0000-1000-8000-00805f9b34fb";

/** Pause between two notifications of EMG, in ms. */
const PERIOD = 10;

const encoder = new TextEncoder();
const bytesOf = (value) => Array.from(new Uint8Array(value.buffer, value.byteOffset, value.byteLength));

export class Radio {
  #device;
  #heard = () => {};
  #arrival = null;
  /** Characteristics by their UUIDs. */
  #found = new Map();

  constructor(device) {
    this.#device = device;
    device.addEventListener("gattserverdisconnected", () => this.#tell({ radio: "disconnected" }));
  }

  static get works() {
    return "bluetooth" in navigator;
  }

  /** Lets the user choose an armband; fails if none is chosen. */
  static async choose() {
    const filters = [{ services: [CONTROL] }];
    return new Radio(await navigator.bluetooth.requestDevice({ filters, optionalServices: [EMG, IMU, BATTERY] }));
  }

  get name() {
    return this.#device.name ?? "";
  }

  run(heard) {
    this.#heard = heard;
    this.#arrival = new Arrival((now) => heard("", now));
  }

  #tell(event) {
    // Its four characteristics of EMG have their turns.
    const period = event.characteristic?.slice(6, 8) === "05" ? PERIOD : 0;
    this.#heard(encoder.encode(JSON.stringify(event)), this.#arrival?.time(period));
  }

  async take(action) {
    const { gatt } = this.#device;
    if (action.radio === "connect") {
      this.#tell({ radio: await gatt.connect().then(() => "connected", () => "connect_failed") });
    } else if (action.radio === "disconnect") {
      // The end of a connection is an event; one that is not there yet fails.
      gatt.disconnect();
    } else {
      this.#tell(await this.#operate(action).catch(() => ({ radio: "failed" })));
    }
  }

  async #operate({ radio, characteristic: uuid, bytes }) {
    const characteristic = this.#found.get(uuid);
    switch (radio) {
      case "discover":
        this.#found.clear();
        for (const service of await this.#device.gatt.getPrimaryServices()) {
          for (const one of await service.getCharacteristics()) {
            this.#found.set(one.uuid, one);
          }
        }
        return { radio: "discovered", found: [...this.#found.keys()] };
      case "read":
        return { radio: "read", bytes: bytesOf(await characteristic.readValue()) };
      case "subscribe":
        characteristic.oncharacteristicvaluechanged = ({ target }) =>
          this.#tell({ radio: "notification", characteristic: uuid, bytes: bytesOf(target.value) });
        await characteristic.startNotifications();
        return { radio: "done" };
      default:
        await characteristic.writeValueWithResponse(new Uint8Array(bytes));
        return { radio: "done" };
    }
  }

  async close() {
    this.#heard = () => {};
    this.#arrival?.stop();
    this.#device.gatt.disconnect();
  }
}
