// The socket: frames and texts come in, messages go out; it connects again by itself.

import { Stream } from "./pictures.js";

const RETRY = 1000; // ms

export class Link {
  // `take` has the functions frame(state, picture, bytes), text(told), state(open) and broken().
  constructor(take) {
    this.take = take;
    this.busy = false;
    this.waiting = null;
    this.shown = 0;
    this.stream = new Stream((state, picture) => this.show(state, picture), (state) => {
      this.acknowledge(state);
      take.broken();
    });
    this.connect();
  }

  connect() {
    const address = new URL("socket" + location.search, location.href);
    address.protocol = address.protocol.replace("http", "ws");
    this.socket = new WebSocket(address);
    this.socket.binaryType = "arraybuffer";
    this.socket.onopen = () => {
      this.shown = 0; // another server counts anew
      this.take.state(true);
    };
    this.socket.onmessage = (event) => this.receive(event.data);
    this.socket.onclose = () => {
      this.take.state(false);
      setTimeout(() => this.connect(), RETRY);
    };
  }

  send(message, values = {}) {
    if (this.socket.readyState === WebSocket.OPEN) {
      this.socket.send(JSON.stringify({ message, ...values }));
    }
  }

  receive(data) {
    if (typeof data === "string") {
      this.take.text(JSON.parse(data));
      return;
    }
    const length = new DataView(data).getUint32(0, true);
    const state = JSON.parse(new TextDecoder().decode(new Uint8Array(data, 4, length)));
    const bytes = new Uint8Array(data, 4 + length);
    state.bytes = data.byteLength;
    state.arrived = performance.now();
    if (state.picture !== "jpeg") {
      this.stream.add(state, bytes);
      return;
    }
    this.stream.end();
    this.waiting = { state, bytes }; // a newer picture takes the place of one that waits
    if (!this.busy) this.showAll();
  }

  async showAll() {
    this.busy = true;
    try {
      while (this.waiting) {
        const { state, bytes } = this.waiting;
        this.waiting = null;
        const bitmap = await createImageBitmap(new Blob([bytes], { type: "image/jpeg" }));
        this.show(state, bitmap);
        bitmap.close();
      }
    } finally {
      this.busy = false;
    }
  }

  show(state, picture) {
    try {
      // A picture of one coding may be ready before an older one of the other.
      if (state.frame > this.shown) this.take.frame(state, picture);
      this.shown = Math.max(this.shown, state.frame);
    } finally {
      this.acknowledge(state);
    }
  }

  acknowledge(state) {
    this.send("ack", { frame: state.frame, spent: performance.now() - state.arrived });
  }
}
