// Roads, traffic, drone, what it sees, and the target; north is up, the drone in the middle.

const RADIUS = 160; // m, from the middle to the edge

export class Minimap {
  constructor(canvas) {
    this.canvas = canvas;
    this.context = canvas.getContext("2d");
    this.roads = [];
    this.traffic = [];
  }

  async load() {
    const answer = await fetch("map.json" + location.search);
    if (!answer.ok) return;
    const { lanes, widths } = await answer.json();
    this.roads = lanes.map((points, i) => ({ points, width: widths[i] }));
  }

  draw(state) {
    if (state.traffic) this.traffic = state.traffic;
    const scale = Math.min(devicePixelRatio || 1, 2);
    const side = this.canvas.clientWidth * scale;
    if (this.canvas.width !== side) this.canvas.width = this.canvas.height = side;
    const context = this.context;
    const light = matchMedia("(prefers-color-scheme: light)").matches;
    const zoom = side / 2 / RADIUS;
    const [x, y, , yaw] = state.drone;
    context.setTransform(1, 0, 0, 1, 0, 0);
    context.clearRect(0, 0, side, side);
    context.setTransform(zoom, 0, 0, -zoom, side / 2 - x * zoom, side / 2 + y * zoom);
    context.lineCap = context.lineJoin = "round";
    context.strokeStyle = light ? "#aab4c0" : "#4b5868";
    for (const road of this.roads) {
      context.lineWidth = Math.max(road.width, 3);
      context.beginPath();
      for (const point of road.points) context.lineTo(...point);
      context.stroke();
    }
    context.beginPath();
    for (const point of state.footprint) context.lineTo(...point);
    context.closePath();
    context.fillStyle = "rgb(64 204 255 / .25)";
    context.fill();
    context.strokeStyle = "#22b8cf";
    context.lineWidth = 1.4 / zoom * scale;
    context.stroke();
    for (const [east, north, heading, , length] of this.traffic) {
      const size = Math.min(0.5 + 0.25 * length, 2.5); // people are dots
      this.car(east, north, heading, light ? "#5b6879" : "#c9d3df", size * scale / zoom);
    }
    this.car(...state.target.place, "#ff4580", 2.3 * scale / zoom);
    this.arrow(x, y, yaw, 5 * scale / zoom);
  }

  car(x, y, yaw, colour, size) {
    const context = this.context;
    context.save();
    context.translate(x, y);
    context.rotate(yaw);
    context.fillStyle = colour;
    context.fillRect(-1.4 * size, -size * 0.8, 2.8 * size, 1.6 * size);
    context.restore();
  }

  arrow(x, y, yaw, size) {
    const context = this.context;
    context.save();
    context.translate(x, y);
    context.rotate(yaw);
    context.beginPath();
    for (const point of [[1.4, 0], [-1, 0.9], [-0.5, 0], [-1, -0.9]]) context.lineTo(point[0] * size, point[1] * size);
    context.closePath();
    context.fillStyle = "#22b8cf";
    context.fill();
    context.strokeStyle = "#04222a";
    context.lineWidth = size * 0.2;
    context.stroke();
    context.restore();
  }
}
