// What is held down, on keyboard, screen and gamepad; sent on each change and every 100 ms.

const REPEAT = 100; // ms
const PLAIN = {
  ArrowUp: "forward", ArrowDown: "back", ArrowLeft: "turn_left", ArrowRight: "turn_right",
  KeyW: "camera_up", KeyS: "camera_down", KeyA: "camera_left", KeyD: "camera_right",
  KeyC: "camera_centre",
};
const SHIFTED = { ArrowUp: "climb", ArrowDown: "sink", ArrowLeft: "left", ArrowRight: "right" };
const DEAD = 0.15; // of a stick

export class Keys {
  constructor(link) {
    this.link = link;
    this.codes = new Set();
    this.touched = new Set();
    this.sequence = 0;
    this.time = 0;
    this.last = "{}";
    addEventListener("keydown", (event) => this.down(event));
    addEventListener("keyup", (event) => this.up(event));
    addEventListener("blur", () => this.release());
    document.addEventListener("visibilitychange", () => document.hidden && this.release());
    for (const button of document.querySelectorAll("[data-control]")) this.listen(button);
    setInterval(() => this.send(), REPEAT);
    const poll = () => { this.changed(); requestAnimationFrame(poll); };
    addEventListener("gamepadconnected", poll, { once: true });
  }

  down(event) {
    this.shift = event.shiftKey;
    if (event.ctrlKey || event.metaKey || event.altKey || isField(event.target)) return;
    if (event.code in PLAIN) {
      event.preventDefault();
      this.codes.add(event.code);
    }
    this.changed();
  }

  up(event) {
    this.shift = event.shiftKey;
    this.codes.delete(event.code);
    this.changed();
  }

  release() {
    this.codes.clear();
    this.touched.clear();
    for (const button of document.querySelectorAll("[data-control].on")) button.classList.remove("on");
    this.changed();
  }

  listen(button) {
    const control = button.dataset.control;
    const hold = (on) => {
      this.touched[on ? "add" : "delete"](control);
      button.classList.toggle("on", on);
      this.changed();
    };
    button.addEventListener("pointerdown", (event) => {
      event.preventDefault();
      button.setPointerCapture(event.pointerId);
      hold(true);
    });
    for (const name of ["pointerup", "pointercancel", "lostpointercapture"]) {
      button.addEventListener(name, () => hold(false));
    }
    button.addEventListener("contextmenu", (event) => event.preventDefault());
  }

  held() {
    const held = {};
    if (!document.hasFocus()) return held;
    for (const code of this.codes) {
      held[(this.shift && SHIFTED[code]) || PLAIN[code]] = 1;
    }
    for (const control of this.touched) held[control] = 1;
    for (const pad of navigator.getGamepads ? navigator.getGamepads() : []) if (pad) sticks(pad, held);
    return held;
  }

  changed() {
    const now = JSON.stringify(this.held());
    if (now === this.last) return;
    this.last = now;
    this.time = performance.now();
    this.send();
  }

  send() {
    this.sequence += 1;
    this.link.send("keys", { held: this.held(), sequence: this.sequence, time: this.time });
  }
}

export function isField(element) {
  return ["SELECT", "INPUT"].includes(element.tagName);
}

// After a click the keys fly again; who works by the keyboard stays where they are.
let byKeyboard = false;
addEventListener("keydown", () => { byKeyboard = true; }, true);
addEventListener("pointerdown", () => { byKeyboard = false; }, true);

export function release(element) {
  if (!byKeyboard) element.blur();
}

function sticks(pad, held) {
  const axis = (value, less, more) => {
    if (Math.abs(value || 0) > DEAD) held[value < 0 ? less : more] = Math.min(Math.abs(value), 1);
  };
  axis(pad.axes[0], "turn_left", "turn_right");
  axis(pad.axes[1], "climb", "sink");
  axis(pad.axes[2], "left", "right");
  axis(pad.axes[3], "forward", "back");
  const cross = { 12: "camera_up", 13: "camera_down", 14: "camera_left", 15: "camera_right", 11: "camera_centre" };
  for (const [number, control] of Object.entries(cross)) if (pad.buttons[number]?.pressed) held[control] = 1;
}
