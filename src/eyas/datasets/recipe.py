"""Recipes: what a data set is made of, one JSON file; docs/datasets.md tells every key."""

from collections.abc import Iterator
from importlib.resources import files
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, Field, model_validator

from eyas.engine.behaviours.config import ExtraConfig
from eyas.engine.core.allowed import TextForm
from eyas.engine.core.config import Config, updated, validated
from eyas.engine.core.errors import ConfigError, UnknownNameError
from eyas.engine.core.named_code import NAMES_CODE, code_named
from eyas.engine.core.variation import Variation
from eyas.engine.settings.config import EyasConfig
from eyas.engine.settings.file import read_settings
from eyas.engine.settings.trust import code_of, refuse_named
from eyas.engine.targets.config import TargetName

SHIPPED = ("detect", "follow", "sot")  # Names of the recipes that come with Eyas
SPLITS = ("train", "val", "test")

LICENCES = {
    "cc0-1.0": "https://creativecommons.org/publicdomain/zero/1.0/",
    "cc-by-4.0": "https://creativecommons.org/licenses/by/4.0/",
    "cc-by-sa-4.0": "https://creativecommons.org/licenses/by-sa/4.0/",
    "mit": "https://opensource.org/license/mit",
    "odbl": "https://opendatacommons.org/licenses/odbl/1-0/",
}
"""Licences by their names on the Hugging Face hub, and where each is told."""


def _different(values: tuple[Any, ...]) -> tuple[Any, ...]:
    if not values or any(value in values[:at] for at, value in enumerate(values)):
        raise ValueError("a list with at least one value, and none twice")
    return values


Several = AfterValidator(_different)
Count = Annotated[int, Field(ge=1, le=10_000)]
Names = Annotated[tuple[str, ...], Several]


class Camera(Config):
    """A camera model; a part is recorded by one."""

    width: Annotated[int, Field(ge=8, le=8192)] = 640
    """[pixels]"""
    height: Annotated[int, Field(ge=8, le=8192)] = 480
    """[pixels]"""
    field_of_view: Variation = 0.7854
    """Horizontal [rad]; a variation is sampled anew for each episode."""


class Split(Config):
    """A part of the data set that learns, chooses or judges."""

    share: Annotated[float, Field(gt=0, le=1)]
    """Share of all frames."""
    maps: Annotated[Names, NAMES_CODE]
    """Its places. Maps on the same roads are one place, and no place is in two splits unless the
    recipe says `shared_places`."""


class Splits(Config):
    """The splits; one that is left out has no frames."""

    train: Split | None = None
    val: Split | None = None
    test: Split | None = None

    @model_validator(mode="after")
    def _whole(self) -> "Splits":
        shares = [split.share for split in self.given.values()]
        if abs(sum(shares) - 1.0) > 1e-6:
            raise ValueError(f"shares of the splits that add up to 1, not {sum(shares):g}")
        return self

    @property
    def given(self) -> dict[str, Split]:
        """The splits that have frames, by name."""
        every = {name: getattr(self, name) for name in SPLITS}
        return {name: split for name, split in every.items() if split is not None}


class Recipe(Config):
    """What a data set is made of. The same recipe in the same build gives the same bytes.

    Of lists such as `weathers`, each part takes one value; all values come equally often.
    """

    name: Annotated[
        str,
        Field(pattern=r"^[a-z0-9][a-z0-9-]{0,63}$"),
        TextForm("up to 64 small letters, digits and hyphens"),
    ]
    """Name of the data set: lower-case letters, digits, hyphens."""
    title: Annotated[str, Field(min_length=1, max_length=200)]
    """Name for people."""
    about: Annotated[str, Field(max_length=4000)] = ""
    """What it is for, for the datasheet."""
    licence: Literal["cc0-1.0", "cc-by-4.0", "cc-by-sa-4.0", "mit", "odbl"] = "cc-by-4.0"
    """Licence of the data, which their maker chooses."""
    date: Annotated[str, Field(pattern=r"^\d{4}-\d\d-\d\d$"), TextForm("YYYY-MM-DD")] | None = None
    """Day of publication, YYYY-MM-DD, for the metadata; the clock is never asked, so that the same
    recipe gives the same bytes."""
    url: (
        Annotated[
            str, Field(pattern=r"^https?://\S+$"), TextForm("an address, http:// or https://")
        ]
        | None
    ) = None
    """Where it is published, for the metadata."""
    seed: Annotated[int, Field(ge=0, lt=2**62)] = 0
    """Seed of the first part; the others have the next ones."""
    frames: Annotated[int, Field(ge=1, le=1_000_000_000)]
    """Number of all frames."""
    episode_frames: Annotated[int, Field(ge=1, le=100_000)] = 50
    """Frames of each episode."""
    fps: Annotated[float, Field(gt=0, le=500)] = 25.0
    """Frames per second of simulated time [Hz]."""
    trackers: Annotated[int, Field(ge=1, le=1024)] = 8
    """Trackers that record a part together, in one world."""
    episodes: Count = 1
    """Episodes of each tracker in a part, one after the other."""
    splits: Splits
    shared_places: bool = False
    """Whether a place may be in several splits, which then have different episodes of its traffic,
    one split after the other in time."""
    weathers: Annotated[Names, NAMES_CODE] = ("day",)
    hours: Annotated[tuple[float | None, ...], Several] = (None,)
    """Times of day, 0 to 24; null: the weather's own sun or moon."""
    targets: Annotated[tuple[TargetName, ...], Several] = (TargetName.SUMO_VEHICLE,)
    heights: Annotated[tuple[Variation, ...], Several] = (19.0,)
    """Heights above the target, at the start and of camera paths [m]."""
    pitches: Annotated[tuple[Variation, ...], Several] = (1.0,)
    """Pitches of the camera, positive down, at the start and of camera paths [rad]."""
    cameras: Annotated[tuple[Camera, ...], Several] = (Camera(),)
    flights: Annotated[Names, NAMES_CODE] = ("follow",)
    """How the trackers fly, see `video.flight`."""
    extras: Annotated[tuple[tuple[ExtraConfig, ...] | None, ...], Several] = (None,)
    """Groups that share the world with the targets; null: the map's pedestrians."""
    factors: dict[str, Annotated[tuple[dict[str, Any], ...], Several]] = {}  # noqa: RUF012
    """Further choices by name: each a list of changes of settings, of which a part takes one."""
    settings: dict[str, Any] = {}  # noqa: RUF012  # pydantic copies it
    """Changes of settings in all parts."""
    places: dict[str, dict[str, Any]] = {}  # noqa: RUF012  # the same
    """Changes of settings on single maps."""
    variants: dict[Annotated[str, Field(pattern=r"^[a-z0-9]{1,32}$")], dict[str, Any]] = {}  # noqa: RUF012
    """Every part is recorded once with each of these changes of settings, with the same seed and
    the same traffic, so that frames correspond; empty: once."""
    writers: Annotated[Names, NAMES_CODE] = ("jpeg", "labels")
    """What is recorded, see `video.writers`."""
    formats: Annotated[tuple[str, ...], NAMES_CODE] = ()
    """Formats of `eyas export` that it holds, too."""

    @model_validator(mode="after")
    def _with_labels(self) -> "Recipe":
        if "labels" not in self.writers:
            raise ValueError("writers must hold 'labels', of which all that tells of the data "
                             "set is made")  # fmt: skip
        return self


def read_recipe(named: str, *, trust: bool = False) -> Recipe:
    """Return a recipe that ships, or that of a JSON file.

    Args:
        named: `detect`, `follow`, `sot`, or the path of a file.
        trust: Whether the file may name code, see `eyas.engine.settings.trust`.

    Raises:
        UnknownNameError: There is no such recipe, and no such file.
        ConfigError: A key or a value is wrong, or the file names code without being trusted.
        DataFileError: The file is not a JSON object.
    """
    if named in SHIPPED:
        path = Path(str(files("eyas.datasets"))) / "recipes" / f"{named}.json"
        return validated(Recipe, read_settings(path))
    path = Path(named)
    if not path.exists() and not named.endswith(".json"):
        raise UnknownNameError("RECIPE", named, SHIPPED, others="a JSON file")
    try:
        recipe = validated(Recipe, read_settings(path))
        code = list(_code_of(recipe))
    except ConfigError as error:
        raise ConfigError(f"{path}: {error}") from None
    if not trust:
        refuse_named(path, code)
    return recipe


def _code_of(recipe: Recipe) -> Iterator[tuple[str, str]]:
    """Yield each piece of code that a recipe names: its path, and what it names."""
    yield from code_named(recipe)
    changes = [("settings", recipe.settings)]
    changes += [(f"places.{name}", change) for name, change in recipe.places.items()]
    changes += [(f"variants.{name}", change) for name, change in recipe.variants.items()]
    for name, values in recipe.factors.items():
        changes += [(f"factors.{name}.{at}", change) for at, change in enumerate(values)]
    for path, change in changes:
        try:
            config = updated(EyasConfig(), change)
        except ConfigError as error:
            raise ConfigError(f"{path}.{error}") from None
        yield from ((f"{path}.{setting}", code) for setting, code in code_of(config))
