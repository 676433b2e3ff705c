"""Shards: parts of a rollout and of each minibatch, done side by side in threads.

What a shard does depends on its own environments and random numbers alone, so the number of threads
changes no byte of the result, and a shard could as well run in another process.
"""

from collections.abc import Callable, Iterable
from concurrent.futures import ThreadPoolExecutor
from typing import TypeVar

import torch

__all__ = ["Crew"]

Job = TypeVar("Job")
Result = TypeVar("Result")


class Crew:
    """Threads, one for each shard; PyTorch uses one thread in each of them.

    With several threads of its own, PyTorch is many times slower beside the renderer's, which its
    waiting threads keep from the processors; and its results would depend on their number.

    Args:
        shards: Number of threads.
    """

    def __init__(self, shards: int) -> None:
        torch.set_num_threads(1)
        self._threads = ThreadPoolExecutor(shards, "eyas-shard")

    def each(self, do: Callable[[Job], Result], jobs: Iterable[Job]) -> list[Result]:
        """Return what `do` gives for each job, in their order."""
        return list(self._threads.map(do, jobs))
