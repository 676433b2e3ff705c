"""Films by a link of some 40 characters, `citystreet/day/fast/4711/1f3a9c2e`, to the byte.

The link has the map, the weather, the policy, the seed of the episode, and a fingerprint of the
program, which is not the build's id; further choices of the menus follow as `/hour=19`. A map or
policy of the user's own is
`name~digest` or `~digest`: its files must be the same. The film is one minute of the drone's
camera, from the start of the episode, and its digest that of the bytes of all its pictures.
"""

import re
from hashlib import sha256
from pathlib import Path
from typing import Any, NamedTuple
from urllib.parse import unquote

import numpy as np
from numpy.typing import NDArray

from eyas.benchmark.policies.shipped import shipped_names
from eyas.benchmark.policies.table import POLICIES, fingerprint
from eyas.demo.choices import WorldChoice, choice_of, chosen_in
from eyas.demo.controllers import PolicyController
from eyas.demo.flight import DemoFlight
from eyas.demo.messages import LONGEST_LINK, WorldMessage
from eyas.demo.offer import BOXES, Offer
from eyas.demo.recording import DemoRecording
from eyas.demo.views import Screen
from eyas.engine.core.clock import PHYSICS_RATE
from eyas.engine.core.config import validated
from eyas.engine.core.errors import ConfigError
from eyas.engine.core.identity.build import this_build
from eyas.engine.core.identity.program import code_of
from eyas.engine.settings.config import EyasConfig
from eyas.engine.sim.config import SimConfig
from eyas.engine.terminal.progress import frames_bar
from eyas.engine.world.maps import MAPS

SECONDS = 60.0  # Of the simulation
STEPS = 20  # Physics steps from one picture to the next: the 25 pictures a second of `eyas video`
SIZE = (640, 480)  # Width and height of the pictures [pixels]
DIGITS = 8  # Of each digest

_FORM = re.compile(
    rf"(?P<map>[\w~-]+)/(?P<weather>[\w-]+)/(?P<policy>[\w~-]+)/(?P<seed>[0-9]{{1,19}})"
    rf"/(?P<fingerprint>[0-9a-f]{{{DIGITS}}})(?P<more>(?:/(?:target|tracker|light|hour|vehicles|people)=[\w.-]+)*)"
)
_NUMBER = re.compile(r"\d{1,3}(\.\d{1,6})?", re.ASCII)
_EXAMPLE = "citystreet/day/fast/4711/1f3a9c2e"
_NOT_SEEN = {"reward", "done", "seed"}  # Settings that change no picture of a film, or are its own


class FilmLink(NamedTuple):
    """A film that can be flown here."""

    choice: WorldChoice  # The world
    policy: str  # As the menu has it
    seed: int
    text: str  # The link

    def same_world(self, other: WorldChoice) -> bool:
        """Return whether another world is the film's."""
        return not _differences(self.choice, other) and self.choice.config.seed == other.config.seed


def read_link(text: str, offer: Offer) -> FilmLink:
    """Return the film of a link, also of one behind `#` in an address.

    Raises:
        ConfigError: It is not a link, is of another program, or names what is not here: one line.
    """
    code = unquote(text[: LONGEST_LINK + 1].rpartition("#")[2].strip())
    found = _FORM.fullmatch(code) if len(text) <= LONGEST_LINK else None
    if found is None:
        raise ConfigError(f"link: {code[:60]!r} is not a link of a film; such as {_EXAMPLE!r}")
    maps = {_map_tag(name): name for name in offer.maps}
    policies = {_policy_tag(name): name for name in offer.policies}
    for part, known in (("map", maps), ("policy", policies)):
        if found[part] not in known:
            names = ", ".join(sorted(tag for tag in known if tag))
            raise ConfigError(
                f"link: {part}: {found[part][:60]!r} is not here, or its files differ; "
                f"known: {names:.400}"
            )
    policy = policies[found["policy"]]
    if found["fingerprint"] != (now := fingerprint_of(policy)):
        raise ConfigError(
            f"link: its program has the fingerprint {found['fingerprint']}, this one {now}, so "
            "pictures may differ: fly it with the version of Eyas that made it"
        )
    more = dict(pair.split("=") for pair in found["more"].split("/")[1:])
    values = {name: _number(text) for name, text in more.items()}
    values |= {"map": maps[found["map"]], "weather": found["weather"]}
    said = validated(WorldMessage, values, "link")
    choice = choice_of(_usual(), said, offer)
    seed = int(found["seed"])
    validated(EyasConfig, {"seed": seed}, "link")
    return FilmLink(choice, policy, seed, code)


def link_of(world: WorldChoice, policy: str, seed: int, offer: Offer) -> FilmLink:
    """Return the film of a policy in the world of a session.

    Raises:
        ConfigError: No link can hold it: one line.
    """
    tags = {"map": _map_tag(world.config.world.map), "policy": _policy_tag(policy)}
    for part, tag in tags.items():
        if not tag:
            raise ConfigError(f"link: not with this {part}, which another machine does not have")
    if world.config.custom is not None:
        raise ConfigError("link: not with this target, which another machine does not have")
    chosen = chosen_in(world, offer)
    place = {name: chosen.pop(name) for name in ("map", "weather")}
    usual = chosen_in(choice_of(_usual(), WorldMessage(**place), offer), offer)
    head = f"{tags['map']}/{place['weather']}/{tags['policy']}/{seed}/{fingerprint_of(policy)}"
    missed: list[list[str]] = []
    # What looks as usual in the menus may still be said in the settings.
    for names in ([name for name in chosen if chosen[name] != usual[name]], [*chosen]):
        text = "/".join([head, *(f"{name}={_short(chosen[name])}" for name in names)])
        film = read_link(text, offer)
        missed.append(_differences(film.choice, world))
        if not missed[-1]:
            return film
    fewest = min(missed, key=len)
    raise ConfigError(f"link: it cannot hold the settings {', '.join(fewest)} of this world")


def fingerprint_of(policy: str) -> str:
    """Return digits that differ where the pictures of a film may: by the build, the code of films
    and, for networks, the library that runs them.
    """
    code = [code_of(one, libraries=False) for one in (Film, WorldChoice, PolicyController)]
    known = f"{this_build().id} {code}"
    if policy not in POLICIES.built_in:  # a network
        known += this_build().libraries.get("onnxruntime", "")
    return sha256(known.encode()).hexdigest()[:DIGITS]


def _usual() -> WorldChoice:
    config = EyasConfig()
    return WorldChoice(config, config.traffic.max_vehicles)


def _number(text: str) -> int | float | str:
    if not _NUMBER.fullmatch(text):
        return text
    return float(text) if "." in text else int(text)


def _short(value: object) -> str:
    return f"{value:g}" if isinstance(value, float) else str(value)


def _differences(one: WorldChoice, other: WorldChoice) -> list[str]:
    """Return the settings in which two worlds differ, of those that are seen."""
    differ = [
        name
        for name in SimConfig.model_fields
        if name not in _NOT_SEEN and getattr(one.config, name) != getattr(other.config, name)
    ]
    return differ + ["traffic"] * (one.vehicles != other.vehicles)


def _map_tag(name: str) -> str:
    """Return what a link calls a map; nothing if other machines cannot have the same."""
    if name in MAPS.built_in:
        return name
    recipe = MAPS.get(name)
    try:
        data = recipe.data_hash()
    except OSError:  # it was there a moment ago
        return ""
    if data is None:
        return ""
    known = f"{data} {sorted(recipe.checksums.items())}"
    return f"{recipe.name}~{sha256(known.encode()).hexdigest()[:DIGITS]}"


def _policy_tag(name: str) -> str:
    """Return what a link calls a policy; nothing if other machines cannot have the same."""
    if name in (*POLICIES.built_in, *shipped_names()):
        return name
    if name == BOXES or name.endswith(".json"):  # what is outside answers as it likes
        return ""
    try:
        digest = fingerprint(name)
    except OSError:
        return ""
    return f"~{digest[:DIGITS]}" if digest else ""


def begun(
    link: FilmLink, flight: DemoFlight, seconds: float = SECONDS
) -> tuple["Film", PolicyController]:
    """Return a film, and what flies it, from the start of its episode on.

    Raises:
        EyasError: The policy cannot fly.
    """
    flight.reset(link.seed)
    return Film(link, flight, seconds), PolicyController(link.policy, flight)


def flown(link: FilmLink, seconds: float, folder: Path | None) -> "Film":
    """Return a film that is flown to its end; in a folder, it is recorded as by `eyas video`.

    Raises:
        EyasError: It cannot be flown or recorded.
    """
    flight = link.choice.build()
    film, controller = begun(link, flight, seconds)
    recording = None if folder is None else DemoRecording(flight, folder, SIZE)
    with frames_bar("flying", round(seconds * PHYSICS_RATE / STEPS), quiet=False) as progress:
        try:
            while not film.over:
                command, left = controller.decide()
                while left > 0 and not film.over:
                    some = min(left, film.steps_left)
                    flight.fly(command, some, {})
                    film.count(some)
                    left -= some
                    if recording is not None:
                        recording.count(command, some)
                    if film.steps_left == STEPS:
                        progress(film.pictures)
        except BaseException:
            if recording is not None:
                recording.abandon()
            raise
    if recording is not None:
        recording.end()
    return film


class Film:
    """The pictures of a film, while it is flown.

    Attributes:
        picture: The last one, shape (480, 640, 3).
        pictures: How many there were.

    Args:
        link: What it is a film of.
        flight: A flight in its world, which stands at the start of its episode.
        seconds: Its length; links are of whole ones.
    """

    def __init__(self, link: FilmLink, flight: DemoFlight, seconds: float = SECONDS) -> None:
        self.link, self.pictures, self._left, self._seconds = link, 0, STEPS, seconds
        self._screen, self._digest = Screen(flight), sha256()
        self.picture: NDArray[np.uint8] = self._screen.draw(*SIZE).copy()

    @property
    def steps_left(self) -> int:
        """Physics steps until the next picture."""
        return self._left

    @property
    def over(self) -> bool:
        """Whether all pictures are drawn."""
        return self.pictures * STEPS >= self._seconds * PHYSICS_RATE

    @property
    def digest(self) -> str:
        """Digest of the bytes of all pictures until now."""
        return self._digest.hexdigest()[: 2 * DIGITS]

    def count(self, steps: int) -> None:
        """Count steps; draw a picture if one is due."""
        self._left -= steps
        if self._left == 0:
            self._left, self.pictures = STEPS, self.pictures + 1
            self.picture = self._screen.draw(*SIZE).copy()
            self._digest.update(self.picture.tobytes())

    def state(self) -> dict[str, Any]:
        """Return what the page shows of it."""
        left = self._seconds - self.pictures * STEPS / PHYSICS_RATE
        return {
            "link": self.link.text,
            "policy": self.link.policy,
            "left": round(left, 1),
            "digest": self.digest if self.over else None,
        }
