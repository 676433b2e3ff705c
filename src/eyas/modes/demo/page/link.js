// The socket: frames and texts come in, messages go out; it connects again by itself.

const RETRY = 1000; // ms

export class Link {
  // `take` has the functions frame(state, bitmap), text(told) and state(open).
  constructor(take) {
    this.take = take;
    this.busy = false;
    this.waiting = null;
    this.connect();
  }

  connect() {
    const address = new URL("socket" + location.search, location.href);
    address.protocol = address.protocol.replace("http", "ws");
    this.socket = new WebSocket(address);
    this.socket.binaryType = "arraybuffer";
    this.socket.onopen = () => this.take.state(true);
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
    this.waiting = data; // a newer frame takes the place of one that waits
    if (!this.busy) this.showAll();
  }

  async showAll() {
    this.busy = true;
    while (this.waiting) {
      const data = this.waiting;
      this.waiting = null;
      const length = new DataView(data).getUint32(0, true);
      const state = JSON.parse(new TextDecoder().decode(new Uint8Array(data, 4, length)));
      try {
        const picture = new Blob([new Uint8Array(data, 4 + length)], { type: "image/jpeg" });
        const bitmap = await createImageBitmap(picture);
        this.take.frame(state, bitmap);
        bitmap.close();
      } finally {
        this.send("ack", { frame: state.frame });
      }
    }
    this.busy = false;
  }
}
