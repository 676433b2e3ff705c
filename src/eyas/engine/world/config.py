"""Settings of the world."""

import re
from typing import Annotated, Any

from pydantic import AfterValidator, Field, model_validator

from eyas.engine.core.config import Config
from eyas.engine.core.named_code import NAMES_CODE
from eyas.engine.core.variation import Variation, within

Brightness = Annotated[Variation, AfterValidator(within(-100.0, 100.0))]
Visibility = Annotated[Variation, AfterValidator(within(0.1, 1e6))]


class WorldWindConfig(Config):
    """The wind, the same everywhere but for its gusts."""

    speed: Annotated[Variation, AfterValidator(within(0.0, 30.0))] = 6.0
    """Mean speed [m/s]; drawn for each episode."""
    direction: Annotated[Variation, AfterValidator(within(-6.3, 6.3))] = 0.0
    """Direction towards which it blows, counter-clockwise from east [rad]; drawn likewise."""


_SIMPLE = "simpleway"  # First part of the names of the simple maps


def world_of(path: str) -> tuple[str, str] | None:
    """Return map and weather that the path of the original's world file names; None: it names none.

    They are `<map>-<weather>.wbt`, `simpleway-<skin>_<weather>.wbt`, and `simpleway-<skin>.wbt`,
    which is one by day.
    """
    found = re.fullmatch(r"(?:.*[/\\])?([^/\\]+)-([^-/\\]+)\.wbt", path)
    if not found:
        return None
    name, weather = found[1], found[2]
    if name != _SIMPLE:
        return name, weather
    skin, joint, rest = weather.rpartition("_")
    return (f"{_SIMPLE}-{skin}", rest) if joint else (f"{_SIMPLE}-{weather}", "day")


class WorldConfig(Config):
    """The map and its weather."""

    map: Annotated[str, Field(min_length=1), NAMES_CODE] = "citystreet"
    """Name of the map, or the path of a plan (`my.plan.json`) or of a user's own,
    `package.module:attribute`. The name of a world file of the original (`lake-night.wbt`) names
    the weather, too, where no other is given."""
    weather: Annotated[str, Field(min_length=1), NAMES_CODE] = "day"
    """Name of the weather, or the path of a user's own, `package.module:attribute`."""
    seed: Annotated[int, Field(ge=0, lt=2**31)] = 0
    """Seed of the map: 0 is the canonical map, other seeds give other maps of the same kind."""
    hour: Annotated[float, Field(ge=0.0, le=24.0)] | None = None
    """Time of day [h], which moves the sun and its shadows as on a day in May at 45° north, with
    dusk, night and dawn; `null`: the weather's own sun or moon."""
    precipitation: Annotated[float, Field(ge=0.0, le=4.0)] = 1.0
    """How much snow, rain or leaves fall, times as much as the weather's own."""
    wind: WorldWindConfig | None = None
    """Wind that sways plants and carries what falls (docs/weather.md): mean speed [m/s], and
    direction towards which it blows, counter-clockwise from east [rad], sampled for each tracker
    at each reset. A flown drone with a `drag_area` feels it, too; `tracker.wind` then says only
    how gusty it is. `null`: plants are still, and what falls drifts by itself."""
    smoke: Annotated[int, Field(ge=0, le=16)] = 0
    """Number of plumes of smoke, which rise over buildings chosen by `seed`."""
    spray: bool = False
    """Whether fast vehicles throw up water where roads are wet."""
    moon: Annotated[float, Field(ge=0.0, le=1.0)] | None = None
    """Age of the moon as a share of a month, 0 new, 0.25 half, 0.5 full: then moon and stars stand
    where the hour has them, and a night is as dark as its moon. None: always full and high."""

    @model_validator(mode="before")
    @classmethod
    def _of_world_file(cls, values: Any) -> Any:  # noqa: ANN401  # as in pydantic
        named = values.get("map") if isinstance(values, dict) else None
        if not isinstance(named, str) or (found := world_of(named)) is None:
            return values
        return {"weather": found[1], **values, "map": found[0]}


class LightConfig(Config):
    """Changes of light and fog; the original's `Env_Params`."""

    each_reset: bool = True
    """Whether the changes are sampled anew at each reset, or only once at the start."""
    background: Brightness = 0.0
    """Brightness of the sky and its light, a factor without unit."""
    background_replaces: bool = False
    """True: `background` is the brightness; False: it is added to the weather's own."""
    sun: Brightness = 0.0
    """Brightness of the sun, a factor without unit."""
    sun_replaces: bool = False
    """True: `sun` is the brightness; False: it is added to the weather's own."""
    visibility: Visibility | None = None
    """Visibility range in foggy weather [m]; None: the weather's own. No effect in others."""
    flakes: bool = True
    """Whether falling flakes, drops and leaves are drawn in snow, in rain and in autumn."""
