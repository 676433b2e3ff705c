"""What the page's menus offer: what ships, and whatever of the user's own lies where they work.

A page names nothing else: no code, no file and no folder of this machine.
"""

import logging
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import islice
from pathlib import Path
from typing import Any

from eyas.benchmark.policies.chat_agent import open_agent
from eyas.benchmark.policies.shipped import card_of, shipped_names
from eyas.benchmark.policies.table import ABOUT, FILES, FLIGHTS
from eyas.engine.core.errors import EyasError
from eyas.engine.core.named_code import PICKLED
from eyas.engine.custom.config import ENDINGS
from eyas.engine.settings.config import EyasConfig
from eyas.engine.targets.catalogue import KINDS
from eyas.engine.targets.config import TargetName
from eyas.engine.world.maps import MAPS
from eyas.engine.world.maps.recipe import PLAN_SUFFIXES

_LOG = logging.getLogger("eyas")

BOXES = "boxes"  # The name under which a tracker outside flies
BUILT_IN = ("follow", "servo")

_SEVERAL = {"SUMO_VEHICLE": "cars and more", "Pedestrian": "people"}

_MOST = 100  # Largest number of files of a kind in a menu
_NETWORKS = tuple(ending for ending in FILES if ending not in (*PICKLED, FLIGHTS, ".json"))
"""Endings of files that run no code when they are read; others fly by `--policy` only."""


@dataclass(frozen=True, slots=True)
class Offer:
    """What the menus choose from, by the names that a page says."""

    maps: Mapping[str, str]  # Titles; maps of the table, and paths of plans
    targets: Mapping[str, Mapping[str, Any]]  # What each changes in the settings
    policies: Mapping[str, str]  # What each is, in a line

    @classmethod
    def of(cls, config: EyasConfig, policy: str | None = None, folder: Path = Path()) -> "Offer":
        """Return what there is now.

        Args:
            config: The settings of the demo, whose own map and target stay to be chosen.
            policy: A policy that was named on the command line.
            folder: Where to look for plans, for `targets` and `protos`, and for policies, also in
                `policies` and in the trainings below `runs`.
        """
        plans = _files(folder, ("", "maps"), PLAN_SUFFIXES)
        names = dict.fromkeys((config.world.map, *sorted(MAPS.names()), *plans))
        named = {policy: "a policy of yours"} if policy else {}
        return cls(
            {name: title for name in names if (title := _title(name)) is not None},
            dict(_targets(config, folder)),
            {**_shipped(), **dict.fromkeys(_policies(folder), "a policy of yours"), **named},
        )


def _title(name: str) -> str | None:
    """Return the title of a map; None if it cannot be read, which the log says."""
    try:
        return MAPS.get(name).title
    except EyasError as error:
        _LOG.warning("the map %s is left out: %s", name, error)
        return None


def _shipped() -> dict[str, str]:
    own = {name: ABOUT[name] for name in BUILT_IN}
    taught = {name: card_of(name).title.replace("`", "") for name in shipped_names()}
    return own | {name: f"a network, taught {what}" for name, what in taught.items()}


def _targets(config: EyasConfig, folder: Path) -> Iterator[tuple[str, dict[str, Any]]]:
    for name in TargetName:
        yield name.value, {"target": name, "custom": None}
    if config.custom is not None:
        yield "custom", {"custom": config.custom.model_dump()}
    for path in _files(folder, ("targets", "protos", ""), ENDINGS):
        track = Path(path).with_suffix(".csv")
        moved = {"trajectory": str(track)} if (folder / track).is_file() else {}
        yield path, {"custom": {"mesh": str(folder / path), **moved}}


def words_of(target: str) -> str:
    """Return a target of the menu in words; of a file its name."""
    known = {**{kind.name: kind.models[0].words[0] for kind in KINDS}, **_SEVERAL}
    return known.get(target, Path(target).stem.replace("_", " "))


def _policies(folder: Path) -> Iterator[str]:
    yield from _files(folder, ("", "policies", "runs/*"), _NETWORKS)
    for path in _files(folder, ("", "policies"), (".json",)):
        try:
            open_agent(folder / path, {})
        except EyasError:  # a file of something else
            continue
        yield path


def _files(folder: Path, inside: tuple[str, ...], endings: tuple[str, ...]) -> list[str]:
    """Return the files with some endings in folders of a folder, as paths relative to it."""
    found = (
        path
        for within in inside
        for path in sorted(folder.glob(f"{within}/*" if within else "*"))
        if path.name.lower().endswith(endings) and path.is_file()
    )
    return [path.relative_to(folder).as_posix() for path in islice(found, _MOST)]
