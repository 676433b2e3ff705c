"""The programs of traffic lights in a network of SUMO: what each shows at any time."""

from enum import IntEnum
from typing import Final, NamedTuple
from xml.etree import ElementTree

import numpy as np
from numpy.typing import NDArray

from eyas.traffic.record import WARM_UP

__all__ = ["Aspect", "SignalPlan", "signal_plan", "walk_plan"]


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

    def only(self, row: int) -> "SignalPlan":
        """Return the plan of one light."""
        one = slice(row, row + 1)
        return SignalPlan(
            self.edges[one], self.cycle[one], self.offset[one], self.end[one], self.aspect[one]
        )


def signal_plan(xml: bytes) -> SignalPlan:
    """Return the plan of a network of SUMO.

    Lights that SUMO switches by what drives show amber, as what they will show is not known.
    """
    root = ElementTree.fromstring(xml)
    programs = _programs(root)
    links: dict[str, tuple[str, int, str]] = {}
    for one in root.iter("connection"):
        edge, light = one.attrib["from"], one.get("tl", "")
        if light not in programs or edge.startswith(":"):
            continue
        link = (light, int(one.attrib["linkIndex"]), one.get("dir", "s"))
        if edge not in links or _rank(link) < _rank(links[edge]):
            links[edge] = link
    shown = {
        edge: (programs[light], _phases(programs[light], index))
        for edge, (light, index, _) in links.items()
    }
    return _plan(shown)


def walk_plan(xml: bytes) -> SignalPlan:
    """Return what the crossings with lights of a network of SUMO show those on foot.

    Green: who is there may begin to cross. Amber: who is on the way may go on, as red still holds
    up those who drive on the crossed street. Red: it no longer does. Where SUMO switches the
    lights by what drives, always red, as what they will show is not known.
    """
    root = ElementTree.fromstring(xml)
    programs = _programs(root)
    own: dict[str, tuple[str, int]] = {}
    driven: dict[tuple[str, str], list[int]] = {}
    for one in root.iter("connection"):
        light = one.get("tl", "")
        if light in programs:
            link = int(one.attrib["linkIndex"])
            own.setdefault(one.attrib["to"], (light, link))
            driven.setdefault((light, one.attrib["from"]), []).append(link)
    shown = {}
    for crossing in root.iter("edge"):
        name, crossed = crossing.attrib["id"], crossing.get("crossingEdges", "").split()
        if crossing.get("function") == "crossing" and name in own:
            light, link = own[name]
            held = [k for edge in crossed for k in driven.get((light, edge), [])]
            shown[name] = programs[light], _walked(programs[light], link, held)
    return _plan(shown)


def _programs(root: ElementTree.Element) -> dict[str, ElementTree.Element]:
    return {logic.attrib["id"]: logic for logic in root.iter("tlLogic")}


def _plan(
    shown: dict[str, tuple[ElementTree.Element, list[tuple[float, Aspect]]]],
) -> SignalPlan:
    """Return the plan of lights, from the program and the phases of each."""
    phases = [own for _, own in shown.values()]
    most = max((len(own) for own in phases), default=1)
    end, aspect = np.full((len(phases), most), np.inf), np.zeros((len(phases), most), np.int64)
    for row, own in enumerate(phases):
        end[row, : len(own)] = np.cumsum([seconds for seconds, _ in own])
        aspect[row, : len(own)] = [one for _, one in own]
    offset = [float(program.get("offset", "0")) for program, _ in shown.values()]
    cycle = np.where(np.isfinite(end), end, 0.0).max(axis=1, initial=0.0)
    return SignalPlan(tuple(shown), cycle, np.array(offset, np.float64) - WARM_UP, end, aspect)


def _rank(link: tuple[str, int, str]) -> tuple[int, int]:
    return _DIRECTIONS.find(link[2]) % (len(_DIRECTIONS) + 1), link[1]


def _phases(logic: ElementTree.Element, index: int) -> list[tuple[float, Aspect]]:
    """Return duration [s] and aspect of the phases of a link."""
    phases = [
        (float(one.attrib["duration"]), _ASPECTS.get(one.attrib["state"][index], Aspect.DARK))
        for one in logic.iter("phase")
    ]
    return phases if _is_known(logic) else [(1.0, Aspect.AMBER)]


def _walked(logic: ElementTree.Element, own: int, held: list[int]) -> list[tuple[float, Aspect]]:
    """Return duration [s] and aspect of the phases of a crossing, see `walk_plan`.

    Args:
        logic: The program.
        own: Its link.
        held: The links of those who drive on the crossed street towards the junction.
    """
    phases = []
    for one in logic.iter("phase"):
        state = one.attrib["state"]
        stand = all(_ASPECTS.get(state[link]) is Aspect.RED for link in held)
        walk = Aspect.GREEN if _ASPECTS.get(state[own]) is Aspect.GREEN else Aspect.AMBER
        phases.append((float(one.attrib["duration"]), walk if stand else Aspect.RED))
    return phases if _is_known(logic) else [(1.0, Aspect.RED)]


def _is_known(logic: ElementTree.Element) -> bool:
    """Return whether a program depends on the time alone."""
    lasts = sum(float(one.attrib["duration"]) for one in logic.iter("phase"))
    return logic.get("type", "static") == "static" and lasts > 0.0
