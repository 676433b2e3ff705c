// The rewards of the last seconds.

import { t } from "./words.js";

export const KINDS = {
  view: { title: "view", colour: "#22b8cf" },
  distance: { title: "distance", colour: "#f59f45" },
  view_discrete: { title: "view, steps", colour: "#7d8cff" },
  distance_discrete: { title: "distance, steps", colour: "#e26bb4" },
};
const SECONDS = 20;

export class Plot {
  constructor(canvas) {
    this.canvas = canvas;
    this.context = canvas.getContext("2d");
    this.points = [];
  }

  add(state) {
    const last = this.points.at(-1);
    if (last && (state.time < last.time || state.time > last.time + SECONDS)) this.points = [];
    if (last && state.time === last.time) return;
    this.points.push({ time: state.time, ...state.kinds });
    while (this.points[0].time < state.time - SECONDS) this.points.shift();
  }

  draw(now) {
    const scale = Math.min(devicePixelRatio || 1, 2);
    const [width, height] = [this.canvas.clientWidth * scale, this.canvas.clientHeight * scale];
    if (this.canvas.width !== Math.round(width) || this.canvas.height !== Math.round(height)) {
      this.canvas.width = width;
      this.canvas.height = height;
    }
    const context = this.context;
    const style = getComputedStyle(document.documentElement);
    context.clearRect(0, 0, width, height);
    context.font = `${10.5 * scale}px system-ui, sans-serif`;
    const left = 22 * scale, top = 6 * scale, wide = width - left, high = height - top - 16 * scale;
    const y = (value) => top + (1 - value) * high;
    context.fillStyle = style.getPropertyValue("--soft");
    context.strokeStyle = style.getPropertyValue("--line");
    context.lineWidth = scale;
    for (const value of [0, 0.5, 1]) {
      context.fillText(value === 0.5 ? ".5" : `${value}`, 4 * scale, y(value) + 4 * scale);
      context.beginPath();
      context.moveTo(left, y(value));
      context.lineTo(width, y(value));
      context.stroke();
    }
    const end = this.points.at(-1)?.time ?? 0;
    context.fillText(t(`${SECONDS} s ago`), left, height - 2 * scale);
    context.fillText(t("now"), width - 24 * scale, height - 2 * scale);
    const order = Object.keys(KINDS).sort((a, b) => (a === now) - (b === now));
    for (const kind of order) {
      context.beginPath();
      for (const point of this.points) {
        context.lineTo(left + wide * (1 - (end - point.time) / SECONDS), y(point[kind]));
      }
      context.strokeStyle = KINDS[kind].colour;
      context.globalAlpha = kind === now ? 1 : 0.55;
      context.lineWidth = (kind === now ? 2.4 : 1.2) * scale;
      context.lineJoin = "round";
      context.stroke();
    }
    context.globalAlpha = 1;
  }
}
