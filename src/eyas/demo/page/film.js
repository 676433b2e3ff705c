// Films: the link of one, in the field and in the address, by which anybody sees the same pictures.

import { t } from "./words.js";

const by = (id) => document.getElementById(id);

export class FilmCard {
  // `look` changes the view; a film is what the drone's camera sees.
  constructor(link, look) {
    this.link = link;
    this.look = look;
    by("link").addEventListener("keydown", (event) => {
      if (event.key === "Enter") this.open(by("link").value);
    });
    by("link").addEventListener("focus", () => by("link").select());
    by("link").addEventListener("input", () => { by("copy").disabled = true; });
    by("copy").addEventListener("click", () => this.copy());
    addEventListener("hashchange", () => this.openAddress());
  }

  openAddress() {
    const asked = location.hash.slice(1);
    if (asked && asked !== this.shown) this.open(asked);
  }

  open(text) {
    this.link.send("film", { link: text.trim().slice(0, 300) });
  }

  // A film has begun, or is over.
  show({ link, digest }) {
    this.shown = link;
    by("link").value = link;
    by("copy").disabled = false;
    history.replaceState(null, "", `#${link}`);
    by("digest").hidden = !digest;
    by("digest").textContent = digest ? t(`Digest of all pictures: ${digest}, as eyas replay prints it`) : "";
    if (!digest) this.look({ view: "drone", overlay: false });
  }

  async copy() {
    by("link").select();
    try {
      await navigator.clipboard.writeText(`${location.origin}/#${this.shown}`);
    } catch {
      document.execCommand("copy"); // over plain HTTP there is no clipboard
    }
    by("copy").textContent = t("Copied");
    setTimeout(() => { by("copy").textContent = t("Copy"); }, 1500);
  }
}
