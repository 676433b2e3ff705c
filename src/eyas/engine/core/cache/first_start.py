"""What a start tells that finds something missing in the cache: what is made, how much is left."""

import logging
import time
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Final

from eyas.engine.core.cache.folder import EntryKind

_LOG = logging.getLogger("eyas")

_STAGES: Final = {
    EntryKind.PLAN: ("the plan of the map", 0.1),
    EntryKind.SCENE: ("streets, houses and plants", 1.3),
    EntryKind.MOTION: ("traffic and people", 2.0),
    EntryKind.GEOMETRY: ("shapes for the camera", 1.2),
    EntryKind.SHADOWS: ("shadows", 0.1),
    EntryKind.AMBIENT: ("light from the sky", 0.2),
}
"""What is made, in this order: in words of a user, and how long it takes at the usual speed [s]."""

_WORTH_TELLING: Final = 0.5  # Shorter rests are not told [s]

_made: dict[EntryKind, float] = {}  # How long this process has made what [s]


@contextmanager
def told(kind: EntryKind) -> Iterator[None]:
    """Tell that something is made meanwhile, in a record that passes: it has `passing`."""
    start = time.perf_counter()
    if kind in _STAGES:
        _tell(kind)
    try:
        yield
    finally:
        if kind in _STAGES:
            _made[kind] = _made.get(kind, 0.0) + time.perf_counter() - start
            _LOG.info("", extra={"passing": True})


def _tell(kind: EntryKind) -> None:
    kinds = list(_STAGES)
    done, left = (
        sum(_STAGES[one][1] for one in some)
        for some in (kinds[: kinds.index(kind)], kinds[kinds.index(kind) :])
    )
    usual = sum(_STAGES[one][1] for one in _made)
    seconds = left * (sum(_made.values()) / usual if usual > 1.0 else 1.0)
    if seconds > _WORTH_TELLING:
        line, share = "making %s, once; %.0f %% done, about %.0f s left", done / (done + left)
        args = _STAGES[kind][0], 100.0 * share, max(seconds, 1.0)
        _LOG.info(line, *args, extra={"passing": True})
