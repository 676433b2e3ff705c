"""Evaluation by the processes of Ray; all of Ray that evaluations need is imported here."""

import logging
import os
import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from eyas.core.errors import EyasError, MissingExtraError
from eyas.evaluation.episode import Episode
from eyas.evaluation.fliers import Flier, flown
from eyas.evaluation.plan import Plan, Stamp, stamp
from eyas.evaluation.record import Record

__all__ = ["on_ray"]

_LOG = logging.getLogger("eyas")

_RETRIES = 3
"""How often a batch is flown again whose process was lost; one that always ends its process, by a
fault in a policy's native code, must not do so for ever."""


@contextmanager
def on_ray() -> Iterator[Flier]:
    """Yield what flies batches on Ray: on the cluster that `ray.init()` finds, or on a local one
    that lasts as long as the block.

    Raises:
        MissingExtraError: Ray is not installed.
        EyasError: There is no cluster at the address that the environment tells.
    """
    try:
        import ray
    except ImportError as error:
        raise MissingExtraError("--ray", "cluster") from error
    begun = not ray.is_initialized()
    if begun:
        _begin(ray)
    try:
        yield lambda plan, parts, _: _fly(ray, plan, parts)
    finally:
        if begun:
            ray.shutdown()


def _begin(ray: Any) -> None:  # noqa: ANN401  # a module
    main = threading.current_thread() is threading.main_thread()
    handler = signal.getsignal(signal.SIGTERM)
    try:
        ray.init()
    except Exception as error:  # Ray has no base for what can go wrong here
        raise EyasError(f"--ray: {_line(error)}") from error
    if main:  # Ray's handler ends the process without a word
        signal.signal(signal.SIGTERM, handler)


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
                raise EyasError(f"--ray: a batch was lost: {_line(error)}") from error
    finally:
        for task in waiting:
            ray.cancel(task, force=True)


def _flown_by_one(made: Stamp, part: list[Episode]) -> list[Record]:
    """Return the records of a batch, flown by the one core that Ray has given this process."""
    os.environ["NUMBA_NUM_THREADS"] = "1"
    try:
        return flown(made, part)
    except EyasError as error:
        raise EyasError(str(error)) from None  # one that can be pickled


def _with_whole_paths(plan: Plan) -> Plan:
    """Return a plan whose files are found from any folder."""
    told = {"policy": plan.policy, "latency": plan.latency}
    whole = {name: str(Path(text).resolve()) for name, text in told.items() if Path(text).is_file()}
    return plan.model_copy(update=whole)


def _line(error: Exception) -> str:
    return " ".join(str(error).split())[:500]
