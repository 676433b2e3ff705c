"""The line of a start that finds something missing in the cache: what is made, how much is left."""

import logging
import time
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Final

from eyas.engine.core.cache.folder import EntryKind

_STAGES: Final = {
    EntryKind.PLAN: ("the plan of the map", 0.1),
    EntryKind.SCENE: ("streets, houses and plants", 1.3),
    EntryKind.MOTION: ("traffic and people", 2.0),
    EntryKind.GEOMETRY: ("shapes for the camera", 1.2),
    EntryKind.SHADOWS: ("shadows", 0.1),
    EntryKind.AMBIENT: ("light from the sky", 0.2),
}
"""What is made, in this order: in words of a user, and how long it takes at the usual speed [s]."""

_made: dict[EntryKind, float] = {}  # How long this process has made what [s]


@contextmanager
def reported(kind: EntryKind) -> Iterator[None]:
    """Report that something is being made, in a record of the log whose `passing` is the stage:
    the next one takes its place on a terminal.
    """
    log, start, kinds = logging.getLogger("eyas"), time.perf_counter(), list(_STAGES)
    if kind not in _STAGES:
        yield
        return
    left = sum(_STAGES[one][1] for one in kinds[kinds.index(kind) :])
    done = 100.0 * (1.0 - left / sum(each for _, each in _STAGES.values()))
    usual = sum(_STAGES[one][1] for one in _made)
    left *= sum(_made.values()) / usual if usual > 1.0 else 1.0
    if left > 0.5:  # a shorter rest is not worth telling
        line = "making %s, once; %.0f %% done, about %.0f s left"
        log.info(line, _STAGES[kind][0], done, max(left, 1.0), extra={"passing": kind})
    try:
        yield
    finally:
        _made[kind] = _made.get(kind, 0.0) + time.perf_counter() - start
        log.info("", extra={"passing": kind})
