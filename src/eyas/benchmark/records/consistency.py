"""Figures of one flight that cannot be together, found without flying it again."""

import math
from collections.abc import Iterator

import numpy as np

from eyas.benchmark.flight.meter import LEAST_LOSS, LOOK, TRACE
from eyas.benchmark.protocols.protocol import Protocol
from eyas.benchmark.records.record import EpisodeRecord

_ROUNDED = 1e-4  # Largest error of a reward in a trace, with room for sums
_SLACK = 1e-6


def contradictions(record: EpisodeRecord, protocol: Protocol) -> Iterator[str]:
    """Yield what in a record contradicts what else stands in it, a line each.

    The trace has the mean reward of each 20 control steps, of which CR is the sum, and TSR the
    share above 0.
    """
    steps = round(record.duration / protocol.period)
    points, rest = divmod(steps, TRACE)
    trace = record.trace
    lengths = {len(trace.reward), len(trace.drone), len(trace.target)}
    if lengths != {points}:
        yield f"its trace has {max(lengths)} points, a flight of {record.duration:g} s has {points}"
        return
    reward = np.array(trace.reward)
    if len(reward) and not (reward.min() >= -_ROUNDED and reward.max() <= 1.0 + _ROUNDED):
        yield "a reward of its trace is not from 0 to 1"
        return
    total = TRACE * float(reward.sum())
    error = TRACE * _ROUNDED * points + _SLACK
    if not total - error <= record.cr <= total + rest + error:
        yield f"cr is {record.cr:.6g}, its trace adds up to {total:.6g}"
    followed = round(record.tsr * protocol.steps)
    # Where a target enters or leaves the picture, a reward can round to 0.
    held = np.pad(reward > 0.0, 1)
    touched = held[:-2] | held[1:-1] | held[2:]
    most = TRACE * int(touched.sum()) + rest
    if followed > most:
        yield f"tsr is {record.tsr:.6g}, by its trace at most {most / protocol.steps:.6g}"
    if record.cr > steps + _SLACK:
        yield f"cr is {record.cr:.6g} in {steps} control steps"
    away = np.linalg.norm(np.array(trace.drone) - np.array(trace.target), axis=-1)
    near = away <= protocol.farthest - _margin(protocol)
    least = int(np.ceil(TRACE * (reward - _ROUNDED))[near].clip(min=0.0).sum()) if points else 0
    if followed < least:
        yield f"tsr is {record.tsr:.6g}, by its trace at least {least / protocol.steps:.6g}"
    yield from _of_losses(record, protocol, followed, steps)
    looks = math.ceil(steps / LOOK) / (protocol.steps // LOOK)
    if not record.visible - _SLACK <= record.seen <= looks + _SLACK:
        yield f"seen is {record.seen:.6g}, visible {record.visible:.6g}"


def _margin(protocol: Protocol) -> float:
    """Return how much farther than over the ground a target can be [m]: the largest height."""
    return protocol.envelope.highest + TRACE * protocol.period * protocol.envelope.speed


def _of_losses(
    record: EpisodeRecord, protocol: Protocol, followed: int, steps: int
) -> Iterator[str]:
    """Yield contradictions between what was followed and what was lost."""
    if (record.found_after is None) != (followed == 0):
        yield f"found_after is {record.found_after}, tsr {record.tsr:.6g}"
    if (record.lost_after is None) != (record.losses == 0):
        yield f"lost_after is {record.lost_after}, losses {record.losses}"
    if record.found_again > record.losses:
        yield f"found_again is {record.found_again}, losses {record.losses}"
    # The last loss may be the end of a flight that was broken off.
    least = round(LEAST_LOSS / protocol.period) * max(record.losses - 1, 0)
    if followed > steps - least:
        yield f"losses are {record.losses}, tsr {record.tsr:.6g}"
    if record.watched > record.duration + _SLACK:
        yield f"watched is {record.watched:g} s of {record.duration:g} s"
