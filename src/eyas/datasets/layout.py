"""The files of a data set, and what tells whether two are of the same plan."""

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from eyas.datasets.plan import DatasetPart, planned, sample_of, shard_of
from eyas.datasets.recipe import SHIPPED, Recipe
from eyas.datasets.statistics import PartFacts
from eyas.engine.core.config import Config, validated
from eyas.engine.core.decoding import read_json
from eyas.engine.core.errors import DataFileError
from eyas.engine.core.files import write_atomic
from eyas.engine.core.identity.build import this_build
from eyas.engine.core.installed import installed_version
from eyas.engine.exports.checksums import SEALED
from eyas.engine.recordings.recording import DATASET_FILE

MAKING_FILE = "making.json"
"""File with the `Plan` of a data set that is being made, until `dataset.json` takes its place."""

RECIPE_FILE = "recipe.json"


class Plan(Config):
    """What a data set is made of and by; two with the same plan are the same to the byte."""

    eyas: str
    """Version of Eyas."""
    build_id: str
    """Build of Eyas."""
    source: str
    """The recipe that ships, or `recipe.json`, which the data set then holds."""
    recipe: Recipe
    sample: bool = False
    """Whether it is a hundredth."""
    shard: tuple[int, int] | None = None
    """Number of the shard, from 1, and of all shards; None: it is whole."""

    @classmethod
    def of(
        cls, recipe: Recipe, named: str, *, sample: bool, shard: tuple[int, int] | None
    ) -> "Plan":
        """Return the plan of a recipe with this Eyas.

        Args:
            shard: Number of the shard, from 1, and of all shards; None: all of it.
        """
        return cls(
            eyas=installed_version(),
            build_id=this_build().id,
            source=named if named in SHIPPED else RECIPE_FILE,
            recipe=recipe,
            sample=sample,
            shard=shard,
        )

    @property
    def command(self) -> str:
        """The command that makes it again, in the folder of the data set."""
        return f"eyas dataset make {self.source}{' --sample' if self.sample else ''} --out DIR"

    @property
    def made(self) -> Recipe:
        """The recipe that is made: that of the sample, if it is one."""
        return sample_of(self.recipe) if self.sample else self.recipe

    def parts(self) -> list[DatasetPart]:
        """Return its parts.

        Raises:
            EyasError: The recipe cannot be met, or there are fewer parts than shards.
        """
        parts = planned(self.made)
        return parts if self.shard is None else shard_of(parts, *self.shard)

    def difference(self, other: "Plan") -> str:
        """Return in words what differs in another plan; nothing if nothing does."""
        mine, others = self.model_dump(mode="json"), other.model_dump(mode="json")
        for name in mine:
            if name == "recipe":
                keys = [key for key in mine[name] if mine[name][key] != others[name][key]]
                if keys:
                    was, now = (json.dumps(each[name][keys[0]]) for each in (mine, others))
                    return f"recipe.{keys[0]} was {was:.200}, is {now:.200}"
            elif mine[name] != others[name]:
                return f"its {name} was {mine[name]!r}, is {others[name]!r}"
        return ""


def read_plan(path: Path) -> Plan:
    """Return the plan that a file holds, `making.json` or `dataset.json`.

    Raises:
        DataFileError: The file is missing, or holds none.
        ConfigError: The recipe in it is not one of this Eyas; one line.
    """
    try:
        found = read_json(path, 1 << 28, "the description of a data set")
        known = {name: found[name] for name in Plan.model_fields}
    except (TypeError, LookupError):
        raise DataFileError(f"{path}: not the description of a data set") from None
    return validated(Plan, known)


def write_plan(
    root: Path, plan: Plan, parts: Sequence[tuple[DatasetPart, PartFacts]] = (), sealed: str = ""
) -> None:
    """Write the plan of a data set: that in the making, or with parts `dataset.json`.

    Raises:
        OutputError: It cannot be written.
    """
    told: dict[str, Any] = plan.model_dump(mode="json")
    if parts:
        told = {"command": plan.command, **told, SEALED: sealed, "parts": described_parts(parts)}
    name = DATASET_FILE if parts else MAKING_FILE
    text = json.dumps(told, indent=1, default=lambda config: config.model_dump(mode="json"))
    write_atomic(root / name, f"{text}\n".encode())


def described_parts(parts: Sequence[tuple[DatasetPart, PartFacts]]) -> list[dict[str, Any]]:
    """Return the parts as `dataset.json` tells them."""
    return [
        {
            "name": part.name,
            "split": part.split,
            "number": part.number,
            "variant": part.variant,
            "seed": part.config.seed,
            "map": part.config.world.map,
            "weather": part.config.world.weather,
            "choices": part.choices,
            "episodes": facts.episodes,
            "frames": facts.frames,
            "checksums": facts.checksums,
        }
        for part, facts in parts
    ]
