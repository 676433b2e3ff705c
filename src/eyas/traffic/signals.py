"""The programs of traffic lights in a network of SUMO: what each shows at any time."""

from enum import IntEnum
from typing import Final, NamedTuple
from xml.etree import ElementTree

import numpy as np
from numpy.typing import NDArray

from eyas.traffic.record import WARM_UP

__all__ = ["Aspect", "SignalPlan", "signal_plan"]


class Aspect(IntEnum):
    """What a traffic light shows."""

    DARK = -1
    RED = 0
    RED_AMBER = 1
    AMBER = 2
    GREEN = 3


_ASPECTS: Final = {
    "r": Aspect.RED,
    "s": Aspect.RED,  # with a green arrow to the right, for those who stop first
    "u": Aspect.RED_AMBER,
    "y": Aspect.AMBER,
    "Y": Aspect.AMBER,
    "o": Aspect.AMBER,  # it blinks: give way
    "g": Aspect.GREEN,
    "G": Aspect.GREEN,
    "O": Aspect.DARK,
}
"""By the letters of SUMO's phases."""

_DIRECTIONS: Final = "slrtLR"
"""What a light shows is for those who drive on in the first of these directions that there is."""


class SignalPlan(NamedTuple):
    """The lights at the ends of E edges; a cycle has up to P phases."""

    edges: tuple[str, ...]
    cycle: NDArray[np.float64]
    """Length of a cycle [s], shape (E,)."""
    offset: NDArray[np.float64]
    """When cycles begin, time of the traffic [s], shape (E,)."""
    end: NDArray[np.float64]
    """When phases end, from the beginning of a cycle [s], shape (E, P)."""
    aspect: NDArray[np.int64]
    """`Aspect` of each phase, shape (E, P)."""

    def at(self, time: NDArray[np.float64]) -> NDArray[np.int64]:
        """Return the `Aspect` of all edges at W times of the traffic [s], shape (W, E)."""
        # Whole microseconds: a phase that ends at a physics step is over then.
        into = np.round(np.mod(time[:, None] - self.offset, self.cycle), 6)
        into = np.where(into >= self.cycle, 0.0, into)
        phase = (into[:, :, None] >= self.end).sum(axis=2)
        shown: NDArray[np.int64] = self.aspect[np.arange(len(self.edges)), phase]
        return shown


def signal_plan(xml: bytes) -> SignalPlan:
    """Return the plan of a network of SUMO.

    Lights that SUMO switches by what drives show amber, as what they will show is not known.
    """
    root = ElementTree.fromstring(xml)
    programs = {logic.attrib["id"]: logic for logic in root.iter("tlLogic")}
    links: dict[str, tuple[str, int, str]] = {}
    for one in root.iter("connection"):
        edge, light = one.attrib["from"], one.get("tl")
        if light not in programs or edge.startswith(":"):
            continue
        link = (light, int(one.attrib["linkIndex"]), one.get("dir", "s"))
        if edge not in links or _rank(link) < _rank(links[edge]):
            links[edge] = link
    phases = [_phases(programs[light], index) for light, index, _ in links.values()]
    most = max((len(own) for own in phases), default=1)
    end, aspect = np.full((len(links), most), np.inf), np.zeros((len(links), most), np.int64)
    for row, own in enumerate(phases):
        end[row, : len(own)] = np.cumsum([seconds for seconds, _ in own])
        aspect[row, : len(own)] = [shown for _, shown in own]
    offset = [float(programs[light].get("offset", "0")) for light, _, _ in links.values()]
    cycle = np.where(np.isfinite(end), end, 0.0).max(axis=1, initial=0.0)
    return SignalPlan(tuple(links), cycle, np.array(offset, np.float64) - WARM_UP, end, aspect)


def _rank(link: tuple[str, int, str]) -> tuple[int, int]:
    return _DIRECTIONS.find(link[2]) % (len(_DIRECTIONS) + 1), link[1]


def _phases(logic: ElementTree.Element, index: int) -> list[tuple[float, Aspect]]:
    """Return duration [s] and aspect of the phases of a link."""
    phases = [
        (float(one.attrib["duration"]), _ASPECTS.get(one.attrib["state"][index], Aspect.DARK))
        for one in logic.iter("phase")
    ]
    known = logic.get("type", "static") == "static" and sum(lasts for lasts, _ in phases) > 0.0
    return phases if known else [(1.0, Aspect.AMBER)]
