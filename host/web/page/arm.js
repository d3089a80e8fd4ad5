// The arm, by the armband's movement: how far the forearm is raised, and where the palm looks. Nothing without movement.

import { find, write } from "./dom.js";
import { t } from "./texts.js";

const degrees = (angle) => (180 * angle) / Math.PI;

/** Whole degrees from this one to another, -180 to 180. */
const between = (one, other) => ((Math.round(other - one) + 540) % 360) - 180;

export class Arm {
  #pitch = 0;
  #roll = 0;
  /** With which sign the arm is raised, and the roll with the palm down; null until the wearer has shown it. */
  #known = null;

  constructor() {
    find("arm-set").addEventListener("click", () => {
      this.#known = { sign: Math.sign(this.#pitch) || 1, roll: this.#roll };
      this.#show();
    });
  }

  /** Takes a unit quaternion of the armband, whose x axis is along the arm; null where there is no stream any more. */
  take(quaternion) {
    find("arm").hidden = quaternion === null;
    if (quaternion === null) {
      this.#known = null;
      return;
    }
    const [w, x, y, z] = quaternion;
    // Height of the armband's three axes.
    const up = [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)];
    this.#pitch = degrees(Math.asin(Math.max(-1, Math.min(1, up[0]))));
    this.#roll = degrees(Math.atan2(up[1], up[2]));
    this.#show();
  }

  #show() {
    find("forearm").toggleAttribute("hidden", !this.#known);
    if (!this.#known) {
      write(find("arm-said"), t("arm.show"));
      return;
    }
    const raised = Math.round(this.#known.sign * this.#pitch);
    const turned = Math.abs(between(this.#known.roll, this.#roll));
    const palm = turned < 45 ? "down" : turned > 135 ? "up" : "side";
    find("forearm").setAttribute("transform", `rotate(${-raised} 24 60)`);
    find("palm").setAttribute("ry", String(4 + 8 * Math.sin((turned * Math.PI) / 180)));
    find("palm").dataset.palm = palm;
    write(find("arm-said"), t("arm.is", { raised: t(raised < 0 ? "arm.lowered" : "arm.raised", { n: Math.abs(raised) }), palm: t(`arm.${palm}`) }));
  }
}
