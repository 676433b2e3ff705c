// The picture, and the overlay over it.

import { named } from "./words.js";

export function rewardColour(reward) {
  const stops = [[242, 66, 51], [255, 199, 31], [89, 230, 77]];
  const at = Math.min(Math.max(reward, 0), 1) * 2;
  const [low, high] = at < 1 ? [stops[0], stops[1]] : [stops[1], stops[2]];
  const share = at < 1 ? at : at - 1;
  return low.map((value, i) => Math.round(value + (high[i] - value) * share)).join(" ");
}

export class Stage {
  constructor(canvas) {
    this.canvas = canvas;
    this.context = canvas.getContext("2d");
    this.state = null;
  }

  // Size in real pixels; the overlay is as sharp as the screen.
  fit() {
    const scale = Math.min(devicePixelRatio || 1, 2);
    const { clientWidth, clientHeight } = this.canvas;
    const width = Math.max(Math.round(clientWidth * scale), 16);
    const height = Math.max(Math.round(clientHeight * scale), 16);
    if (this.canvas.width !== width || this.canvas.height !== height) {
      this.canvas.width = width;
      this.canvas.height = height;
    }
    this.scale = scale;
    return { width, height };
  }

  show(state, picture) {
    this.state = state;
    const { width, height } = this.fit();
    const box = this.box = cover(...state.size, width, height);
    this.context.imageSmoothingQuality = "medium";
    this.context.drawImage(picture, box.x, box.y, box.width, box.height);
    if (state.marks) this.marks(state);
    if (state.body) this.body(state.body);
  }

  // A place on the screen as shares of the picture's sides.
  place(event) {
    const { left, top } = this.canvas.getBoundingClientRect();
    const x = ((event.clientX - left) * this.scale - this.box.x) / this.box.width;
    const y = ((event.clientY - top) * this.scale - this.box.y) / this.box.height;
    return { x: Math.min(Math.max(x, 0), 1), y: Math.min(Math.max(y, 0), 1) };
  }

  marks(state) {
    const { seen, reward, lines, centre, target, tip } = state.marks;
    const colour = rewardColour(state.reward);
    this.shape(reward, null, `rgb(${colour} / .9)`, 1.4); // thin: what is judged is the picture
    this.shape(seen, null, "rgb(64 204 255 / .8)", 1.2);
    for (const line of lines) this.line(line, "rgb(64 204 255 / .7)", 1.2);
    if (centre) this.cross(centre);
    if (centre && target) this.line([centre, target], "rgb(255 255 255 / .7)", 1.2, [5, 5]);
    if (tip) this.gem(tip, state);
  }

  body([hull, nose, ...rotors]) {
    const middle = (points) => [0, 1].map((i) => points.reduce((sum, point) => sum + point[i], 0) / points.length);
    for (const rotor of rotors) this.line([middle(hull), middle(rotor)], "#3d444d", 2.5);
    this.shape(hull, "#eef1f5", "#3d444d", 1);
    this.shape(nose, "#ff9a1a", "#3d444d", 1);
    for (const rotor of rotors) this.shape(rotor, "rgb(150 160 172 / .75)", "#3d444d", 1.2);
  }

  at([x, y]) {
    return [this.box.x + x * this.box.width, this.box.y + y * this.box.height];
  }

  path(points) {
    this.context.beginPath();
    for (const point of points) this.context.lineTo(...this.at(point));
  }

  stroke(colour, width) {
    const context = this.context;
    context.lineJoin = "round";
    context.strokeStyle = "rgb(8 12 18 / .55)";
    context.lineWidth = (width + 2) * this.scale;
    context.stroke();
    context.strokeStyle = colour;
    context.lineWidth = width * this.scale;
    context.stroke();
  }

  shape(points, fill, colour, width) {
    if (points.length < 3) return;
    this.path(points);
    this.context.closePath();
    if (fill) {
      this.context.fillStyle = fill;
      this.context.fill();
    }
    this.stroke(colour, width);
  }

  line(points, colour, width, dashes = []) {
    if (points.length < 2) return;
    this.path(points);
    this.context.setLineDash(dashes.map((dash) => dash * this.scale));
    this.stroke(colour, width);
    this.context.setLineDash([]);
  }

  cross(point) {
    const [x, y] = this.at(point);
    const arm = 9 * this.scale;
    this.context.beginPath();
    this.context.moveTo(x - arm, y);
    this.context.lineTo(x + arm, y);
    this.context.moveTo(x, y - arm);
    this.context.lineTo(x, y + arm);
    this.stroke("rgb(64 204 255)", 2);
  }

  gem(point, state) {
    const [x, y] = this.at(point);
    const s = 7 * this.scale;
    const context = this.context;
    context.beginPath();
    for (const [dx, dy] of [[0, 0], [-s, -1.6 * s], [0, -2.6 * s], [s, -1.6 * s]]) context.lineTo(x + dx, y + dy - 4 * this.scale);
    context.closePath();
    context.fillStyle = "rgb(255 69 128)";
    context.fill();
    this.stroke("rgb(255 168 196)", 1.2);
    context.font = `600 ${13 * this.scale}px system-ui, sans-serif`;
    context.textBaseline = "middle";
    const text = `${named(state.target.words)}  ${state.reward.toFixed(2)}`;
    context.strokeStyle = "rgb(8 12 18 / .8)";
    context.lineWidth = 3.5 * this.scale;
    context.strokeText(text, x + 12 * this.scale, y - 14 * this.scale);
    context.fillStyle = "#fff";
    context.fillText(text, x + 12 * this.scale, y - 14 * this.scale);
  }
}

// Where a picture lies so that it covers all of the screen.
function cover(width, height, wide, high) {
  const scale = Math.max(wide / width, high / height);
  const [w, h] = [width * scale, height * scale];
  return { x: (wide - w) / 2, y: (high - h) / 2, width: w, height: h };
}
