// How the pictures are coded: chosen here, or by the server, which knows what the line carries.

import { release } from "./keys.js";
import { decodesH264 } from "./pictures.js";
import { t } from "./words.js";

const KEY = "eyas-pictures";
const ATTEMPTS = 3; // of H.264, when its pictures cannot be decoded
const SPAN = 2000; // ms
const EVERY = 10; // frames
const NAMES = { jpeg: "JPEG", key: "H.264", delta: "H.264" };
const by = (id) => document.getElementById(id);

export class CodingMenu {
  // `say` shows a line to the user.
  constructor(link, say) {
    this.link = link;
    this.say = say;
    this.failures = 0;
    this.frames = [];
    this.shown = 0;
    by("coding").value = localStorage.getItem(KEY) ?? "auto";
    by("coding").addEventListener("change", () => {
      localStorage.setItem(KEY, by("coding").value);
      this.failures = 0;
      this.ask();
      release(by("coding"));
    });
    this.able = decodesH264();
    this.able.then((able) => {
      if (able) return;
      by("coding").value = "jpeg";
      by("coding").disabled = true;
      by("coding").title = t("This browser does not decode H.264 here");
    });
  }

  async ask() {
    const able = await this.able;
    this.link.send("pictures", { coding: able ? by("coding").value : "jpeg" });
  }

  broken() {
    this.failures += 1;
    if (this.failures === ATTEMPTS) {
      by("coding").value = "jpeg";
      this.say("This browser cannot decode our H.264; pictures go on as JPEG.");
    }
    this.ask();
  }

  show(state) {
    const now = performance.now();
    this.frames.push([now, state.bytes]);
    while (this.frames[0][0] < now - SPAN) this.frames.shift();
    if (this.shown++ % EVERY) return;
    const bytes = this.frames.reduce((sum, [, size]) => sum + size, 0);
    const each = bytes / this.frames.length / 1000;
    by("line").textContent = t(`${NAMES[state.picture]}, ${each.toFixed(0)} kB each, ${(bytes / SPAN).toFixed(0)} kB/s`);
  }
}
