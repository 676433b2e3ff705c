"""The content of an OpenStreetMap file: points, lines and their tags."""

from dataclasses import dataclass, field

__all__ = ["Bounds", "OsmData", "Relation", "Tags", "Way"]

Tags = dict[str, str]
Bounds = tuple[float, float, float, float]  # West, south, east and north, in degrees


@dataclass(frozen=True, slots=True)
class Way:
    """A line of nodes; an area if it is closed and its tags say so."""

    id: int
    nodes: tuple[int, ...]
    tags: Tags


@dataclass(frozen=True, slots=True)
class Relation:
    """A group of ways, for example the outlines of an area with holes."""

    id: int
    members: tuple[tuple[str, int, str], ...]
    """Kind (`node`, `way`, `relation`), id and role of each member."""
    tags: Tags


@dataclass(slots=True)
class OsmData:
    """Everything that an OpenStreetMap file tells and a map can use."""

    places: dict[int, tuple[float, float]] = field(default_factory=dict)
    """Longitude and latitude of each node, in degrees."""
    nodes: dict[int, Tags] = field(default_factory=dict)  # Tags of the nodes that have some
    ways: dict[int, Way] = field(default_factory=dict)
    relations: list[Relation] = field(default_factory=list)
    bounds: Bounds | None = None  # The area that the file says it covers
