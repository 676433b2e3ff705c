"""Starts of drones that cannot follow at once: behind a target that drives, or above one that
stands and sets out.

Behind a target at speed a drone at rest loses it, whoever flies it: it is faster by at most 7.1
m/s each second, so that the target is v^2 / 14.2 m ahead before both are as fast, 10 m at 12 m/s,
and half of the picture is 7 to 9 m.
"""

from collections.abc import Sequence
from dataclasses import replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from eyas.benchmark.episodes.episode import EpisodeSpec, Place
from eyas.benchmark.episodes.first_fitting import first_fitting
from eyas.benchmark.episodes.from_above import seen_from_above
from eyas.benchmark.protocols.protocol import Protocol
from eyas.lanes import exact

AT_REST, AT_SPEED = "at-rest", "at-speed"
"""Variants: the target stands at the start, and the drone hovers; both drive."""

_PERIOD = 0.256  # Time between two looks [s]
_STANDS, _DRIVES = 0.3, 5.0  # Speed below which a target stands, and from which it drives [m/s]

_VISIBLE, _FIRST = 0.5, 4
"""Least share of a target that is visible, and at how many first looks: nobody can know one that
is hidden from the start."""

_AWAY, _WITHIN = 12.0, 10.0
"""How far a target gets from where its first velocity would have brought it [m], and within which
time [s]: beyond the picture of who stays there without looking."""

_TRIED = 400
"""Number of seeds that are tried for each episode: of a hundred starts, one to four are above a
target that stands."""


def setting_out(
    episodes: Sequence[EpisodeSpec], protocol: Protocol, *, at_rest: bool
) -> list[bool]:
    """Return whether each target first stands, or drives, and then does not go on so."""
    seen = seen_from_above(episodes, protocol, _PERIOD)
    first = (seen.places[:, 1] - seen.places[:, 0]) / _PERIOD
    speed = np.asarray(exact.hypot(first[:, 0], first[:, 1]))
    begins = speed < _STANDS if at_rest else speed >= _DRIVES
    visible = seen.shares[:, :_FIRST].min(axis=1) >= _VISIBLE
    fits: list[bool] = (begins & visible & leaves_its_way(seen.places)).tolist()
    return fits


def leaves_its_way(
    places: NDArray[np.float64],  # Of each at K looks, east and north [m], shape (N, K, 2)
) -> NDArray[np.bool_]:
    """Return whether N targets soon are elsewhere than where they would be if they went on as at
    first, shape (N,).
    """
    seen = places[:, : round(_WITHIN / _PERIOD)]
    step = seen[:, 1] - seen[:, 0]
    off = seen - (seen[:, :1] + step[:, None] * np.arange(seen.shape[1])[:, None])
    away = np.asarray(exact.hypot(off[..., 0], off[..., 1]))
    found: NDArray[np.bool_] = away.max(axis=1) >= _AWAY
    return found


def at_rest_and_at_speed(
    places: Sequence[Place], protocol: Protocol, count: int, first_seed: int
) -> list[EpisodeSpec]:
    """Choose the first episodes of each place and direction that fit a variant, for each variant.

    Raises:
        SpawnError: There are too few.
    """
    words = {AT_REST: "a target that stands and sets out", AT_SPEED: "a target that drives"}
    plain, found = replace(protocol, variants={}), []
    for name in protocol.variants:
        fits = partial(setting_out, at_rest=name == AT_REST)
        own = first_fitting(
            places, plain, count, first_seed, fits=fits, wanted=words[name], tried=_TRIED
        )
        found += [episode._replace(variant=name) for episode in own]
    return found
