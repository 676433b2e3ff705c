// Joins the parts of the page.

import { CodingMenu } from "./coding.js";
import { DuelBoard } from "./duel.js";
import { FilmCard } from "./film.js";
import { Keys, isField, release } from "./keys.js";
import { Link } from "./link.js";
import { Minimap } from "./minimap.js";
import { Panel } from "./panel.js";
import { Settings } from "./settings.js";
import { Stage } from "./stage.js";
import { switchLanguage, t, translatePage } from "./words.js";

const by = (id) => document.getElementById(id);
const SLOW = 0.2;
const look = { view: "chase", overlay: true };
const known = {}; // what the server has said last, to be said in another language
const times = [];
const latencies = [];
let last = null;
let lastInput = 0;
let hidesNotice = 0;
let builds = 0;

const stage = new Stage(by("picture"));
const minimap = new Minimap(by("minimap"));
const board = new DuelBoard();
const link = new Link({ frame, text, state: linked, broken: () => coding.broken() });
const coding = new CodingMenu(link, notice);
const settings = new Settings(link);
const film = new FilmCard(link, (changes) => showLook(changes));
const panel = new Panel(settings);
new Keys(link);

function frame(state, picture) {
  last = state;
  stage.show(state, picture);
  minimap.draw(state);
  panel.show(state);
  if (settings.chosen) board.show(state, settings.terms());
  measure(state);
  coding.show(state);
  press("pause", state.speed_of_time === 0);
  press("slow", state.speed_of_time === SLOW);
  press("record", state.recorded !== null);
  by("record").textContent = state.recorded === null ? t("Record") : `● ${state.recorded}`;
  by("pause").textContent = t(state.speed_of_time === 0 ? "Go on" : "Pause");
  press("fly", state.flies !== null && !state.duel && !state.film);
  by("flies").hidden = state.flies === null || Boolean(state.duel);
  by("flies").textContent = state.film
    ? t(`A film of ${state.flies}: ${state.film.left.toFixed(0)} s left`)
    : t(`${state.flies} flies: press a key to take over`);
}

function measure(state) {
  const now = performance.now();
  times.push(now);
  while (times[0] < now - 1000) times.shift();
  if (state.input > lastInput && state.input <= now) {
    lastInput = state.input;
    latencies.push(now - state.input);
    if (latencies.length > 30) latencies.shift();
  }
  const middle = [...latencies].sort((a, b) => a - b)[latencies.length >> 1];
  const wait = middle === undefined ? "" : ` · ${t(`key to picture ${middle.toFixed(0)} ms`)}`;
  by("link-line").textContent = `${state.size.join("×")} · ${times.length} fps${wait}`;
  by("speed-line").textContent = t(`${state.height.toFixed(0)} m up · ${state.speed.toFixed(0)} m/s`);
  window.eyas = { state, world: settings.chosen, latency: middle, frames: times.length }; // for whoever debugs, and tests
}

function text(told) {
  if (told.reload) location.reload();
  Object.assign(known, told.hello && told, told.world && { world: told.world }, told.reward && { reward: told.reward });
  if (told.hello) settings.greet(told);
  if (told.world) {
    settings.world(told.world);
    board.list(settings.terms());
    minimap.load();
  }
  if (told.reward) settings.reward(told.reward);
  if (told.reward && settings.chosen) board.list(settings.terms());
  if ("pilot" in told) {
    by("watching").hidden = told.pilot;
    document.body.classList.toggle("watches", !told.pilot);
  }
  if ("pilot" in told && told.pilot) showLook();
  if ("busy" in told) building(told.busy);
  if (told.film) film.show(told.film);
  if (told.say) notice(t(told.say));
  if (told.error) notice(t(told.error), true);
}

// Another world is being built; what is seen flies on meanwhile.
function building(what) {
  clearInterval(builds);
  if (!what) {
    notice("");
    return;
  }
  const begun = performance.now();
  const show = () => {
    const seconds = Math.floor((performance.now() - begun) / 1000);
    const why = seconds > 5 ? t("; new worlds take up to a minute, known ones seconds") : "";
    notice(t(`Building ${what}: ${seconds} s`) + why, false, 10000);
  };
  show();
  builds = setInterval(show, 1000);
}

function linked(open) {
  document.body.classList.toggle("offline", !open);
  clearInterval(builds);
  if (open) notice("");
  else notice(t("No connection to eyas demo; trying again …"), true, 1e9);
  if (open) {
    showLook();
    coding.ask();
    film.openAddress();
  }
}

function notice(words, error = false, time = 6000) {
  clearTimeout(hidesNotice);
  by("notice").hidden = !words;
  by("notice").textContent = words;
  by("notice").classList.toggle("error", error);
  hidesNotice = setTimeout(() => { by("notice").hidden = true; }, Math.min(time, 2 ** 31 - 1));
}

function press(id, on) {
  by(id).classList.toggle("on", on);
  by(id).setAttribute("aria-pressed", on);
}

function showLook(changes = {}) {
  Object.assign(look, changes);
  const size = stage.fit();
  link.send("look", { ...look, width: Math.min(size.width, 16384), height: Math.min(size.height, 16384) });
  press("overlay", look.overlay);
  for (const button of by("views").children) {
    button.classList.toggle("on", button.dataset.view === look.view);
    button.setAttribute("aria-pressed", button.dataset.view === look.view);
  }
}

function photo() {
  const address = by("picture").toDataURL("image/png");
  const anchor = Object.assign(document.createElement("a"), { href: address, download: "eyas.png" });
  anchor.click();
}

const act = {
  pause: () => link.send("pace", { speed: last?.speed_of_time === 0 ? 1 : 0 }),
  step: () => { link.send("pace", { speed: 0 }); link.send("do", { what: "step" }); },
  slow: () => link.send("pace", { speed: last?.speed_of_time === SLOW ? 1 : SLOW }),
  reset: () => link.send("do", { what: "reset" }),
  next: () => link.send("do", { what: "next_target" }),
  parked: () => link.send("do", { what: "parked_target" }),
  record: () => link.send("record", { on: last?.recorded === null }),
  shot: photo,
  overlay: () => showLook({ overlay: !look.overlay }),
  fly: () => link.send("fly", { policy: last?.flies ? null : by("policy").value }),
  duel: () => link.send("duel", { policy: last?.duel && last.duel.stage !== "over" ? null : by("policy").value }),
  take: () => link.send("do", { what: "pilot" }),
  film: () => link.send("film", { policy: by("policy").value }),
  "record-for": () => link.send("stage", { protocol: by("protocol").value }),
  "help-open": () => by("help").showModal(),
  language: () => {
    switchLanguage();
    if (known.hello) text({ ...known });
  },
};
for (const [id, does] of Object.entries(act)) {
  by(id).addEventListener("click", () => { does(); release(by(id)); });
}
by("views").addEventListener("click", ({ target }) => {
  if (target.dataset.view) showLook({ view: target.dataset.view });
  release(target);
});
by("duel-board").addEventListener("click", ({ target }) => {
  if (target.tagName === "BUTTON" && last?.duel?.stage === "over") link.send("duel", { policy: null });
});
by("picture").addEventListener("click", (event) => {
  if (stage.box) link.send("click", stage.place(event));
});

const letters = {
  p: act.pause, ".": act.step, m: act.slow, r: act.reset, n: act.next, b: act.parked,
  v: act.record, x: act.shot, o: act.overlay, f: act.fly, "?": act["help-open"],
  1: () => showLook({ view: "drone" }), 2: () => showLook({ view: "chase" }), 3: () => showLook({ view: "top" }),
};
addEventListener("keydown", (event) => {
  const typing = isField(event.target) && event.target.type !== "range";
  if (event.repeat || event.ctrlKey || event.metaKey || event.altKey || typing || by("help").open) return;
  letters[event.key.toLowerCase()]?.();
});
translatePage();
new ResizeObserver(() => showLook()).observe(by("picture"));
