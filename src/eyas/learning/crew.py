"""Threads for the parts of a minibatch and for the shards of a rollout.

What a part gives depends on its own data alone, so the number of threads changes no byte.
"""

from collections.abc import Callable, Iterable
from concurrent.futures import ThreadPoolExecutor
from typing import TypeVar

import torch

__all__ = ["Crew"]

Job = TypeVar("Job")
Result = TypeVar("Result")


class Crew:
    """Threads, in each of which PyTorch uses no more threads of its own.

    PyTorch's threads would keep the renderer's from the processors while they wait, and results
    would depend on their number.

    Args:
        threads: Their number.
    """

    def __init__(self, threads: int) -> None:
        torch.set_num_threads(1)
        self._threads = ThreadPoolExecutor(threads, "eyas-learning")

    def each(self, do: Callable[[Job], Result], jobs: Iterable[Job]) -> list[Result]:
        """Return what `do` gives for each job, in their order."""
        return list(self._threads.map(do, jobs))
