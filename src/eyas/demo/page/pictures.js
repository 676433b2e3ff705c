// H.264 pictures, where the browser decodes them: each one needs those before it.

const CODEC = "avc1.42E028"; // baseline, which gives back each picture at once; up to 1280 x 720

// False also for a page that came over plain HTTP from another machine: WebCodecs is for secure pages only.
export async function decodesH264() {
  try {
    return (await VideoDecoder.isConfigSupported({ codec: CODEC, optimizeForLatency: true })).supported;
  } catch {
    return false;
  }
}

export class Stream {
  // `show(state, picture)` takes each picture; `fail(state)` the last state whose picture cannot be decoded.
  constructor(show, fail) {
    this.show = show;
    this.fail = fail;
    this.states = new Map();
  }

  add(state, data) {
    const key = state.picture === "key";
    if (key) this.begin();
    if (!this.decoder) {
      this.fail(state);
      return;
    }
    this.states.set(state.frame, state);
    try {
      this.decoder.decode(new EncodedVideoChunk({ type: key ? "key" : "delta", timestamp: state.frame, data }));
    } catch {
      this.end();
      this.fail(state);
    }
  }

  begin() {
    this.end();
    const decoder = new VideoDecoder({
      output: (picture) => {
        const state = this.states.get(picture.timestamp);
        this.states.delete(picture.timestamp);
        if (state && decoder === this.decoder) this.show(state, picture);
        picture.close();
      },
      error: () => {
        if (decoder !== this.decoder) return;
        const last = [...this.states.values()].at(-1);
        this.end();
        if (last) this.fail(last);
      },
    });
    decoder.configure({ codec: CODEC, optimizeForLatency: true });
    this.decoder = decoder;
  }

  end() {
    if (this.decoder && this.decoder.state !== "closed") this.decoder.close();
    this.decoder = null;
    this.states.clear();
  }
}
