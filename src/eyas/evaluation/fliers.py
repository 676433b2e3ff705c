"""Who flies the batches of a plan: this process, or the processes of a cluster."""

from collections.abc import Callable, Iterator

from eyas.core.errors import ConfigError
from eyas.evaluation.episode import Episode
from eyas.evaluation.plan import Plan, Stamp, fly_batch, stamp
from eyas.evaluation.record import Record

__all__ = ["Flier", "flown", "fly_here"]

Flier = Callable[[Plan, list[list[Episode]], list[float]], Iterator[list[Record]]]
"""Yields the records of batches, in any order, but those of a batch one after the other. It adds
to the last argument how long each call of the policy has taken [s], if this machine has made it."""


def fly_here(
    plan: Plan, parts: list[list[Episode]], answers: list[float]
) -> Iterator[list[Record]]:
    """Fly batches in this process; a record is there as soon as its episode ends."""
    for part in parts:
        yield from fly_batch(plan, part, answers)


def flown(made: Stamp, part: list[Episode]) -> list[Record]:
    """Return the records of a batch: the same on every machine, however often it is flown.

    Raises:
        ConfigError: This machine has another build of Eyas, or another or no file of the policy.
        EyasError: The policy cannot be loaded here.
    """
    try:
        here = stamp(made.plan)
    except OSError as error:
        raise ConfigError(f"{made.plan.policy}: cannot read on a worker: {error}") from None
    if differs := made.other_build(here):
        raise ConfigError(f"a worker has another build of Eyas, which differs in {differs}")
    if here.policy != made.policy:
        raise ConfigError(f"a worker has another policy: {here.policy}, not {made.policy}")
    return [record for ended in fly_batch(made.plan, part) for record in ended]
