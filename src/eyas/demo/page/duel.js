// You against a policy: the board over the picture, and the best flights, kept in this browser.

import { t } from "./words.js";

const KEY = "eyas-best-flights-by-terms";
const MOST = 5;
const by = (id) => document.getElementById(id);

export class DuelBoard {
  constructor() {
    this.stage = null;
  }

  // `terms`: under what flights can be compared.
  show(state, terms) {
    const duel = state.duel;
    by("duel-board").hidden = !duel;
    const left = duel ? Math.ceil(duel.ready) : 0;
    by("countdown").hidden = !left;
    by("countdown").textContent = left;
    by("duel").textContent = t(duel && duel.stage !== "over" ? "Give up" : "You against it: 60 s");
    if (!duel) {
      this.stage = null;
      return;
    }
    if (this.stage && this.stage !== "over" && duel.stage === "over") this.keep(duel, terms);
    this.stage = duel.stage;
    const { you, policy } = duel.scores;
    const side = (name, score, active) => {
      const part = document.createElement("div");
      part.classList.toggle("active", active);
      const number = document.createElement("b");
      number.textContent = score.toFixed(1);
      part.append(name, document.createElement("br"), number);
      return part;
    };
    const sides = document.createElement("div");
    sides.className = "sides";
    sides.append(side(t("you"), you, duel.stage === "you"), side(duel.policy, policy, duel.stage === "policy"));
    if (duel.stage === "over" && this.closing) return; // a button that is made anew cannot be pressed
    this.closing = duel.stage === "over";
    by("duel-board").replaceChildren(this.line(duel), sides);
  }

  line(duel) {
    const line = document.createElement("div");
    const { you, policy } = duel.scores;
    if (duel.stage === "over") {
      const close = document.createElement("button");
      close.className = "round";
      close.textContent = "×";
      close.ariaLabel = close.title = t("Close");
      line.append(t(you > policy ? "You win!" : you === policy ? "A draw." : `${duel.policy} wins.`), " ", close);
    } else if (duel.ready > 0) {
      line.textContent = t(`${duel.stage === "you" ? "Your turn" : `Now ${duel.policy}`} in ${Math.ceil(duel.ready)} …`);
    } else {
      line.textContent = t(`${duel.left.toFixed(0)} s left: keep the target in the middle`);
    }
    return line;
  }

  // All flights that were kept: lists by their terms.
  kept() {
    try {
      const kept = JSON.parse(localStorage.getItem(KEY) ?? "{}");
      return kept && typeof kept === "object" && !Array.isArray(kept) ? kept : {};
    } catch {
      return {};
    }
  }

  keep(duel, terms) {
    const flight = { ...duel.scores, name: duel.policy, day: new Date().toISOString().slice(0, 10) };
    const kept = this.kept();
    kept[terms] = [...(kept[terms] ?? []), flight].sort((a, b) => b.you - a.you).slice(0, MOST);
    localStorage.setItem(KEY, JSON.stringify(kept));
    this.list(terms);
  }

  list(terms) {
    const flights = this.kept()[terms] ?? [];
    const rows = flights.map((flight) => row("td", [flight.day, flight.you, `${flight.name} ${flight.policy}`]));
    by("best").title = t("Flights in this world, with this tracker and this reward");
    by("best").replaceChildren(...(rows.length ? [row("th", ["Best flights here", "you", "it"].map((text) => t(text))), ...rows] : []));
  }
}

function row(kind, cells) {
  const line = document.createElement("tr");
  for (const cell of cells) {
    const part = document.createElement(kind);
    part.textContent = cell;
    line.append(part);
  }
  return line;
}
