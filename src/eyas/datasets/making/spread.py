"""The parts of a data set, recorded by the processes of Ray, on any machine of its cluster.

A recorded part comes back as one archive, so the machines need no common disk. A part whose process
or machine was lost is made again; its bytes are the same wherever it is made.
"""

import io
import tarfile
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from eyas.benchmark.flight.policy_runner import Ray, connected, one_line
from eyas.datasets.making.make import Recorded
from eyas.datasets.making.parts import PART_FILE, read_facts, record_part
from eyas.datasets.plan import DatasetPart, in_order_of_work
from eyas.datasets.statistics import PartFacts
from eyas.engine.core.errors import ConfigError, EyasError
from eyas.engine.core.files import refusals
from eyas.engine.core.identity.build import this_build
from eyas.engine.core.scratch import scratch
from eyas.lanes import limit_threads

_RETRIES = 3  # How often a part is made again whose process was lost

_WAITING = 2
"""Parts that are made or wait for each core: archives that are done wait in memory, too."""


@contextmanager
def on_ray() -> Iterator[Recorded]:
    """Yield what records parts on Ray, see `connected` for where and for errors."""
    with connected() as ray:
        yield lambda parts, root: _recorded(ray, parts, root)


def _recorded(
    ray: Ray, parts: Sequence[DatasetPart], root: Path
) -> Iterator[tuple[DatasetPart, PartFacts]]:
    cores = max(1, int(ray.cluster_resources().get("CPU", 1)))
    task = ray.remote(num_cpus=1, max_retries=_RETRIES)(_archive_of)
    build, left, busy = this_build().id, in_order_of_work(parts), dict[Any, DatasetPart]()
    try:
        while left or busy:
            while left and len(busy) < _WAITING * cores:
                part = left.pop(0)
                busy[task.remote(part, build)] = part
            done, _ = ray.wait(list(busy))
            part = busy.pop(done[0])
            try:
                _unpack(ray.get(done[0]), root / part.folder)
            except ray.exceptions.RayTaskError as error:
                raise getattr(error, "cause", error) from None
            except ray.exceptions.RayError as error:
                raise EyasError(f"--ray: {part.name} was lost: {one_line(error)}") from error
            facts = read_facts(root / part.folder)
            assert facts is not None
            yield part, facts
    finally:
        for waiting in busy:
            ray.cancel(waiting, force=True)


def _archive_of(part: DatasetPart, build: str) -> bytes:
    """Return a recorded part as an archive, made by the one core of this process."""
    limit_threads(1)
    here = this_build().id
    if here != build:
        raise ConfigError(f"a worker has another build of Eyas: {here}, not {build}")
    with scratch() as root:
        record_part(part, root)
        packed = io.BytesIO()
        with tarfile.open(fileobj=packed, mode="w") as archive:
            folder = root / part.folder
            for path in sorted(folder.rglob("*")):
                if path.is_file():
                    archive.add(path, path.relative_to(folder).as_posix())
        return packed.getvalue()


def _unpack(packed: bytes, folder: Path) -> None:
    """Put the files of a part into its folder; the one that says that it is complete comes last."""
    with refusals(folder), tarfile.open(fileobj=io.BytesIO(packed)) as archive:
        folder.mkdir(parents=True, exist_ok=True)
        last = archive.getmember(PART_FILE)
        archive.extractall(
            folder, [each for each in archive.getmembers() if each is not last], filter="data"
        )
        archive.extract(last, folder, filter="data")
