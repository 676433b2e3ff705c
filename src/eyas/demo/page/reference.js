// Flights of a protocol, recorded for a leaderboard.

import { Keys } from "./keys.js";
import { Link } from "./link.js";
import { t, translatePage } from "./words.js";

const by = (id) => document.getElementById(id);
const canvas = by("picture");
const context = canvas.getContext("2d");
const link = new Link({ frame, text, state: linked, broken: () => link.send("pictures", { coding: "jpeg" }) });
new Keys(link);

function frame(state, picture) {
  const width = picture.displayWidth ?? picture.width;
  const height = picture.displayHeight ?? picture.height;
  if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, { width, height });
  context.drawImage(picture, 0, 0);
  if (state.box) {
    const [left, top, right, bottom] = state.box;
    context.strokeStyle = "#22b8cf";
    context.lineWidth = 2;
    context.strokeRect(left * width - 3, top * height - 3, (right - left) * width + 6, (bottom - top) * height + 6);
  }
  const flying = state.stage === "flying";
  by("board").hidden = true;
  by("leave").hidden = !flying;
  by("clock").hidden = !flying;
  by("clock").textContent = flying ? `${state.time.toFixed(0)} s` : "";
  by("countdown").hidden = flying;
  by("countdown").textContent = flying ? "" : Math.ceil(state.left);
  by("words").hidden = !state.words;
  by("words").textContent = state.words ?? ""; // as policies get them, in no other language
  window.eyas = { state }; // for whoever debugs, and tests
}

const LINES = {
  making: (at) => at.total ? `Flight ${at.number} of ${at.total} is being made …` : "The flights are being made …",
  ready: (at) => `Flight ${at.number} of ${at.total}, ${at.map}.`,
  over: (at) => `All flights are recorded, in ${at.folder}.`,
};

function text(told) {
  if (told.protocol) {
    by("title").textContent = t(`Flights for ‘${told.protocol}’`);
    by("about").textContent = t(told.title);
    by("back").hidden = !told.back;
  }
  if (told.reload) location.reload();
  if (told.reference) stage(told.reference);
  if ("pilot" in told && !told.pilot) by("line").textContent = t("Another page has the controls.");
  if (told.error) by("line").textContent = t(told.error);
}

function stage(at) {
  for (const id of ["leave", "clock", "countdown", "words"]) by(id).hidden = true;
  by("board").hidden = false;
  by("ask").hidden = at.stage !== "ready";
  by("line").textContent = t(LINES[at.stage](at));
  if (at.stage === "ready") by("pilot").focus();
}

function linked(open) {
  if (open) return;
  by("board").hidden = false;
  by("ask").hidden = true;
  by("line").textContent = t("No connection to eyas demo; trying again …");
}

by("board").addEventListener("submit", (event) => {
  event.preventDefault();
  document.activeElement?.blur();
  by("ask").hidden = true;
  link.send("ready", { pilot: by("pilot").value.trim(), device: by("device").value });
});
by("leave").addEventListener("click", () => link.send("leave"));
by("back").addEventListener("click", () => link.send("stage", { protocol: null }));
translatePage();
