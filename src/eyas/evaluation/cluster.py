"""Evaluation by the processes of Ray."""

import logging
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from eyas.core.cluster import connected, one_line
from eyas.core.errors import EyasError
from eyas.evaluation.episode import Episode
from eyas.evaluation.fliers import Flier, flown
from eyas.evaluation.plan import Plan, Stamp, stamp
from eyas.evaluation.record import Record
from eyas.lanes import limit_threads

__all__ = ["on_ray"]

_LOG = logging.getLogger("eyas")

_RETRIES = 3
"""How often a batch is flown again whose process was lost; one that always ends its process, by a
fault in a policy's native code, must not do so for ever."""


@contextmanager
def on_ray() -> Iterator[Flier]:
    """Yield what flies batches on Ray, see `connected` for where and for errors."""
    with connected() as ray:
        yield lambda plan, parts, _: _fly(ray, plan, parts)


def _fly(ray: Any, plan: Plan, parts: list[list[Episode]]) -> Iterator[list[Record]]:  # noqa: ANN401
    """Yield the records of batches as they are done."""
    cores = int(ray.cluster_resources().get("CPU", 1))
    if len(parts) < cores and any(len(part) > 1 for part in parts):
        _LOG.warning(
            "%d batches for %d cores: a smaller --batch lets more of them fly", len(parts), cores
        )
    made = stamp(_with_whole_paths(plan))
    task = ray.remote(num_cpus=1, max_retries=_RETRIES)(_flown_by_one)
    waiting = [task.remote(made, part) for part in parts]
    try:
        while waiting:
            done, waiting = ray.wait(waiting)
            try:
                yield ray.get(done[0])
            except ray.exceptions.RayTaskError as error:
                raise getattr(error, "cause", error) from None
            except ray.exceptions.RayError as error:
                raise EyasError(f"--ray: a batch was lost: {one_line(error)}") from error
    finally:
        for task in waiting:
            ray.cancel(task, force=True)


def _flown_by_one(made: Stamp, part: list[Episode]) -> list[Record]:
    """Return the records of a batch, flown by the one core that Ray has given this process."""
    limit_threads(1)
    try:
        return flown(made, part)
    except EyasError as error:
        raise EyasError(str(error)) from None  # one that can be pickled


def _with_whole_paths(plan: Plan) -> Plan:
    """Return a plan whose files are found from any folder."""
    told = {"policy": plan.policy, "latency": plan.latency}
    whole = {name: str(Path(text).resolve()) for name, text in told.items() if Path(text).is_file()}
    return plan.model_copy(update=whole)
