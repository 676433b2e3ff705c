"""The programs of traffic lights in a network of SUMO: what each shows at any time."""

import io
import zipfile
import zlib
from enum import IntEnum
from importlib.resources.abc import Traversable
from pathlib import Path
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.errors import DataFileError
from eyas.engine.core.files import write_atomic
from eyas.engine.traffic.net_file import NetConnection, NetProgram, SumoNet
from eyas.engine.traffic.network import STRAIGHT_FIRST
from eyas.engine.traffic.record import WARM_UP


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


class SignalPlan(NamedTuple):
    """The lights at the ends of E edges; a cycle has up to P phases."""

    edges: tuple[str, ...]
    cycle: NDArray[np.float64]  # Length of a cycle [s], shape (E,)
    offset: NDArray[np.float64]  # When cycles begin, time of the traffic [s], shape (E,)
    end: NDArray[np.float64]  # When phases end, from the beginning of a cycle [s], shape (E, P)
    aspect: NDArray[np.int64]  # `Aspect` of each phase, shape (E, P)

    def at(self, time: NDArray[np.float64]) -> NDArray[np.int64]:
        """Return the `Aspect` of all edges at W times of the traffic [s], shape (W, E)."""
        return self.shown(time[:, None], np.arange(len(self.edges))[None])

    def shown(self, time: NDArray[np.float64], edge: NDArray[np.int64]) -> NDArray[np.int64]:
        """Return the `Aspect` of edges at times of the traffic [s], of shapes that fit."""
        # Whole microseconds: a phase that ends at a physics step is over then.
        # It is done for each picture, and thrice as fast as with `mod` and a sum over the phases.
        cycle, turn = self.cycle[edge], time - self.offset[edge]
        into = np.round(turn - cycle * np.floor(turn / cycle), 6)
        into[into >= cycle] = 0.0
        place = np.zeros(into.shape, np.int64) + self.end.shape[1] * edge
        for end in self.end.T:
            place += into >= end[edge]
        aspect: NDArray[np.int64] = self.aspect.ravel().take(place)
        return aspect

    def only(self, row: int) -> "SignalPlan":
        """Return the plan of one light."""
        one = slice(row, row + 1)
        return SignalPlan(
            self.edges[one], self.cycle[one], self.offset[one], self.end[one], self.aspect[one]
        )


def signal_plan(net: SumoNet) -> SignalPlan:
    """Return the plan of a network of SUMO.

    Lights that SUMO switches by what drives show amber, as what they will show is not known.
    """
    programs = {one.name: one for one in net.programs}
    links: dict[str, NetConnection] = {}
    for one in net.connections:
        if one.light not in programs or one.start.startswith(":"):
            continue
        if one.start not in links or _rank(one) < _rank(links[one.start]):
            links[one.start] = one
    shown = {
        edge: (programs[one.light], _phases(programs[one.light], one.link))
        for edge, one in links.items()
    }
    return _plan(shown)


def save_plan(path: Path, plan: SignalPlan) -> None:
    """Write a plan as npz; the same plan gives the same bytes.

    Raises:
        OutputError: The file cannot be written.
    """
    buffer = io.BytesIO()
    np.savez_compressed(buffer, allow_pickle=False, **plan._asdict())
    write_atomic(path, buffer.getvalue())


def load_plan(file: Traversable) -> SignalPlan:
    """Read a plan.

    Raises:
        DataFileError: The file is truncated or of another kind.
    """
    try:
        with file.open("rb") as opened, np.load(opened) as archive:
            told = {name: archive[name] for name in SignalPlan._fields}
    except (OSError, ValueError, KeyError, EOFError, zipfile.BadZipFile, zlib.error) as error:
        raise DataFileError(f"{file}: not a readable plan of signals: {error}") from error
    return SignalPlan(**{**told, "edges": tuple(told["edges"].tolist())})


def walk_plan(net: SumoNet) -> SignalPlan:
    """Return what the crossings with lights of a network of SUMO show those on foot.

    Green: who is there may begin to cross. Amber: who is on the way may go on, as red still holds
    up those who drive on the crossed street. Red: it no longer does. Where SUMO switches the
    lights by what drives, always red, as what they will show is not known.
    """
    programs = {one.name: one for one in net.programs}
    own: dict[str, tuple[str, int]] = {}
    driven: dict[tuple[str, str], list[int]] = {}
    for one in net.connections:
        if one.light in programs:
            own.setdefault(one.end, (one.light, one.link))
            driven.setdefault((one.light, one.start), []).append(one.link)
    shown = {}
    for crossing in net.edges:
        if crossing.function == "crossing" and crossing.name in own:
            light, link = own[crossing.name]
            held = [k for edge in crossing.crossed for k in driven.get((light, edge), [])]
            shown[crossing.name] = programs[light], _walked(programs[light], link, held)
    return _plan(shown)


def _plan(shown: dict[str, tuple[NetProgram, list[tuple[float, Aspect]]]]) -> SignalPlan:
    """Return the plan of lights, from the program and the phases of each."""
    phases = [own for _, own in shown.values()]
    most = max((len(own) for own in phases), default=1)
    end, aspect = np.full((len(phases), most), np.inf), np.zeros((len(phases), most), np.int64)
    for row, own in enumerate(phases):
        end[row, : len(own)] = np.cumsum([seconds for seconds, _ in own])
        aspect[row, : len(own)] = [one for _, one in own]
    offset = [program.offset for program, _ in shown.values()]
    cycle = np.where(np.isfinite(end), end, 0.0).max(axis=1, initial=0.0)
    return SignalPlan(tuple(shown), cycle, np.array(offset, np.float64) - WARM_UP, end, aspect)


def _rank(one: NetConnection) -> tuple[int, int]:
    return STRAIGHT_FIRST.find(one.direction) % (len(STRAIGHT_FIRST) + 1), one.link


def _phases(logic: NetProgram, index: int) -> list[tuple[float, Aspect]]:
    """Return duration [s] and aspect of the phases of a link."""
    phases = [(one.seconds, _ASPECTS.get(one.state[index], Aspect.DARK)) for one in logic.phases]
    return phases if _is_known(logic) else [(1.0, Aspect.AMBER)]


def _walked(
    logic: NetProgram,
    own: int,  # Its link
    held: list[int],  # The links of those who drive on the crossed street towards the junction
) -> list[tuple[float, Aspect]]:
    """Return duration [s] and aspect of the phases of a crossing, see `walk_plan`."""
    phases = []
    for one in logic.phases:
        state = one.state
        stand = all(_ASPECTS.get(state[link]) is Aspect.RED for link in held)
        walk = Aspect.GREEN if _ASPECTS.get(state[own]) is Aspect.GREEN else Aspect.AMBER
        phases.append((one.seconds, walk if stand else Aspect.RED))
    return phases if _is_known(logic) else [(1.0, Aspect.RED)]


def _is_known(logic: NetProgram) -> bool:
    """Return whether a program depends on the time alone."""
    return logic.kind == "static" and sum(one.seconds for one in logic.phases) > 0.0
