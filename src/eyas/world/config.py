"""Settings of the world."""

from typing import Annotated

from pydantic import Field

from eyas.core.config import Config

__all__ = ["WorldConfig"]


class WorldConfig(Config):
    """Which map, in which weather."""

    map: Annotated[str, Field(min_length=1)] = "citystreet"
    """Name of the map."""
    weather: Annotated[str, Field(min_length=1)] = "day"
    """Name of the weather."""
    seed: Annotated[int, Field(ge=0, lt=2**31)] = 0
    """Seed of the map: 0 is the canonical one, other seeds give other maps of its kind."""
