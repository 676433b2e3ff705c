// The numbers beside the picture.

import { rewardColour } from "./stage.js";
import { KINDS, Plot } from "./plot.js";
import { named, t } from "./words.js";

const REASONS = {
  height: "too low or too high", distance: "too far from its commands", velocity: "too fast",
  yaw_rate: "turns too fast", tilt: "tilts too far", target_lost: "target has left",
  no_reward: "no reward for too long", step_limit: "number of steps reached",
  not_a_number: "not a number",
};
const NUMBERS = [
  ["how central", (s) => s.p.toFixed(3)],
  ["offset", (s) => `${s.offset.toFixed(1)} m`],
  ["distance", (s) => `${s.distance.toFixed(1)} m`],
  ["height", (s) => `${s.height.toFixed(1)} m`],
  ["speed", (s) => `${s.speed.toFixed(1)} m/s`],
  ["climb", (s) => `${s.climb.toFixed(1)} m/s`],
  ["yaw rate", (s) => `${s.yaw_rate.toFixed(0)} °/s`],
  ["camera", (s) => `${s.pitch.toFixed(0)}° / ${s.camera_yaw.toFixed(0)}°`],
  ["target", (s) => named(s.target.words)],
  ["model", (s) => s.target.model],
  ["its speed", (s) => `${s.target.speed.toFixed(1)} m/s`],
  ["time", (s) => `${s.time.toFixed(1)} s`],
];
const EVERY = 3; // frames: numbers that change faster cannot be read

export class Panel {
  constructor(settings) {
    this.settings = settings;
    this.plot = new Plot(document.getElementById("plot"));
    this.kinds = {};
    for (const [kind, { title, colour }] of Object.entries(KINDS)) {
      const item = document.createElement("li");
      item.style.setProperty("--colour", colour);
      const name = document.createElement("span");
      name.textContent = title;
      item.append(name, document.createElement("b"));
      document.getElementById("kinds").append(item);
      this.kinds[kind] = item;
    }
    this.numbers = NUMBERS.map(([name, text]) => {
      const row = document.createElement("div");
      const [term, value] = [document.createElement("dt"), document.createElement("dd")];
      term.textContent = name;
      row.append(term, value);
      document.getElementById("numbers").append(row);
      return { value, text };
    });
    this.shown = 0;
  }

  show(state) {
    this.plot.add(state);
    if (this.shown++ % EVERY) return;
    const now = this.settings.kind();
    this.plot.draw(now);
    document.getElementById("badge-reward").textContent = state.reward.toFixed(2);
    document.getElementById("badge").style.setProperty("--reward", `rgb(${rewardColour(state.reward)})`);
    for (const [kind, item] of Object.entries(this.kinds)) {
      item.lastChild.textContent = state.kinds[kind].toFixed(2);
      item.classList.toggle("now", kind === now);
    }
    for (const { value, text } of this.numbers) value.title = value.textContent = text(state);
    const reasons = document.getElementById("reasons");
    reasons.textContent = t(state.reasons.length ? "A training episode would end: " : "A training episode would go on.");
    if (state.reasons.length) {
      const list = document.createElement("b");
      list.textContent = state.reasons.map((reason) => t(REASONS[reason] ?? reason)).join(", ");
      reasons.append(list);
    }
  }
}
