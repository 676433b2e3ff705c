// The menus of the world, and the sliders of the reward.

import { release } from "./keys.js";
import { named, t } from "./words.js";

const SLIDERS = ["view_range", "view_scale", "distance_range", "distance_scale"];
const NUMBERS = ["vehicles", "people", "hour"];
const PEOPLE = [0, 10, 30, 60];
const LIGHTS = { own: "by the weather" };
const HOURS = { own: "by the weather", 5: "5:00", 7: "7:00", 9: "9:00", 12: "12:00", 15: "15:00", 17: "17:00", 19: "19:00", 20: "20:00", 22: "22:00" };
const by = (id) => document.getElementById(id);

export class Settings {
  constructor(link) {
    this.link = link;
    this.maps = {};
    for (const name of SLIDERS) {
      by(name).addEventListener("input", () => {
        this.label(name);
        this.touched = performance.now();
        link.send("reward", { [name]: Number(by(name).value) });
      });
      by(name).addEventListener("change", () => release(by(name)));
    }
    for (const name of ["type", "mode"]) {
      by(name).addEventListener("change", () => {
        link.send("reward", { [name]: by(name).value });
        release(by(name));
      });
    }
    by("map").addEventListener("change", () => {
      const weathers = this.maps[by("map").value].weathers;
      const weather = weathers.includes(by("weather").value) ? by("weather").value : weathers[0];
      link.send("world", { map: by("map").value, weather });
      release(by("map"));
    });
    for (const name of ["weather", "target", "tracker", "light", "hour", "vehicles", "people"]) {
      by(name).addEventListener("change", () => {
        const { value } = by(name);
        link.send("world", { [name]: NUMBERS.includes(name) && value !== "own" ? Number(value) : value });
        release(by(name));
      });
    }
    by("policy").addEventListener("change", () => {
      this.about();
      release(by("policy"));
    });
    by("save").href = "env_config.json" + location.search;
  }

  // The built-in reward that counts, as the plot names it.
  kind() {
    return by("type").value + (by("mode").value === "discrete" ? "_discrete" : "");
  }

  greet({ maps, policies, protocols, targets, lights, most_vehicles: most }) {
    Object.assign(this, { maps, policies });
    fill(by("target"), Object.entries(targets).map(([name, words]) => [name, named(words), name]));
    fill(by("light"), lights.map((name) => [name, t(LIGHTS[name] ?? name)]));
    fill(by("map"), Object.entries(maps).map(([name, { title }]) => [name, t(short(name)), t(title)]));
    const shares = [0.1, 0.25, 0.5, 1].map((share) => Math.max(Math.round(share * most), 1));
    fill(by("vehicles"), [...new Set(shares)].map((count) => [count, t(`${count} cars`)]));
    fill(by("policy"), Object.keys(policies).map((name) => [name, name === "boxes" ? t("tracker outside") : name]));
    fill(by("protocol"), Object.entries(protocols).map(([name, title]) => [name, name, t(title)]));
    this.about();
  }

  about() {
    by("about").textContent = t(this.policies[by("policy").value] ?? "");
  }

  world(chosen) {
    const { map, people, hour } = chosen;
    this.chosen = chosen;
    fill(by("weather"), [...new Set([...this.maps[map].weathers, chosen.weather])].map((name) => [name, t(name)]));
    const counts = [...new Set([...PEOPLE, people])].sort((a, b) => a - b);
    fill(by("people"), counts.map((count) => [count, count ? `${count}` : t("none")]));
    const hours = [...new Set(["own", ...Object.keys(HOURS).filter(Number), `${hour}`])];
    fill(by("hour"), hours.map((name) => [name, t(HOURS[name] ?? `${name} h`)]));
    for (const name of ["map", "weather", "target", "tracker", "light", "hour", "vehicles", "people"]) by(name).value = chosen[name];
    by("not-saved").hidden = !people && hour === "own";
    by("map").title = t(this.maps[map].title);
    by("vehicles").disabled = chosen.target !== "SUMO_VEHICLE"; // others have the roads to themselves
    by("parked").disabled = !chosen.parked;
  }

  // Under what flights can be compared.
  terms() {
    const { map, weather, light, hour, vehicles, target, tracker, people } = this.chosen;
    const reward = [this.kind(), ...SLIDERS.map((name) => by(name).value)];
    return [map, weather, light, ...(hour === "own" ? [] : [hour]), target, vehicles, people, tracker, ...reward].join(" ");
  }

  reward(values) {
    by("type").value = values.type;
    by("mode").value = values.mode;
    by("kind-now").textContent = `${t(values.type)}, ${t(values.mode)}`;
    if (performance.now() - (this.touched ?? -1e9) < 500) return; // a slider moves under the hand
    for (const name of SLIDERS) {
      by(name).value = values[name];
      this.label(name);
    }
  }

  label(name) {
    by(name).previousElementSibling.textContent = by(name).value;
  }
}

// Of the path of a plan its name.
function short(name) {
  return name.split("/").at(-1).replace(/\.plan\.json(\.gz)?$/, "");
}

// Each option is a value, words, and perhaps more words for whoever rests on it.
function fill(select, options) {
  const chosen = select.value;
  const made = options.map(([value, words, title = ""]) => Object.assign(new Option(words, value), { title }));
  select.replaceChildren(...made);
  if (options.some(([value]) => `${value}` === chosen)) select.value = chosen;
}
