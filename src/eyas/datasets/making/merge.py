"""Joins the shards of a data set, after checking that they are all there and whole."""

import hashlib
import os
import shutil
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from eyas.datasets.layout import Plan, read_plan
from eyas.datasets.making.make import Making, complete, continuable, open_folder, report
from eyas.datasets.making.parts import PART_FILE, read_facts
from eyas.datasets.plan import DatasetPart
from eyas.engine.core.errors import DataFileError
from eyas.engine.core.files import atomic_path, refusals
from eyas.engine.core.folder_lock import LOCK, folder_lock
from eyas.engine.exports.checksums import CHECKSUMS, read_checksums
from eyas.engine.recordings.recording import DATASET_FILE
from eyas.engine.terminal.progress import frames_bar


def merge(shards: Sequence[Path], out: Path, making: Making) -> None:
    """Join shards to the data set that would have been made at once, to the byte.

    Args:
        out: Its folder; files are hard links to those of the shards where the system can do it.

    Raises:
        EyasError: A shard is missing, there twice, of another recipe or build, or damaged; the
            folder is taken, or something cannot be written; one line.
        KeyboardInterrupt: The user stopped it; every file that exists is complete.
    """
    plan, homes = _checked(shards)
    with folder_lock(out, "merging into it"), continuable(out):
        if open_folder(out, plan, resume=making.resume):
            _join(plan.parts(), homes, out, quiet=making.quiet)
            complete(plan, out, making)
    report(plan, str(out), quiet=making.quiet)


def _checked(shards: Sequence[Path]) -> tuple[Plan, dict[str, Path]]:
    """Return the plan of the whole, and the shard that each part lies in."""
    first: Plan | None = None
    known: dict[int, Path] = {}
    homes: dict[str, Path] = {}
    for shard in shards:
        plan = read_plan(shard / DATASET_FILE)
        if plan.shard is None:
            raise DataFileError(f"{shard}: not a shard, but a whole data set")
        number, count = plan.shard
        whole = plan.model_copy(update={"shard": None})
        if first is None:
            first, of = whole, count
        differs = first.difference(whole) or (of != count and f"one of {of} shards, one of {count}")
        if differs:
            raise DataFileError(f"{shard}: not of the same data set as {shards[0]}: {differs}")
        if number in known:
            raise DataFileError(f"{shard}: shard {number} of {of}, as {known[number]} is, too")
        known[number] = shard
        homes |= {part.name: shard for part in plan.parts()}
    if first is None:
        raise DataFileError("SHARD: name the folders of the shards")
    missing = [number for number in range(1, of + 1) if number not in known]
    if missing:
        told = ", ".join(map(str, missing[:10])) + (" ..." if len(missing) > 10 else "")
        raise DataFileError(f"{len(missing)} of {of} shards are missing: {told}")
    here = Plan.of(first.recipe, first.source, sample=first.sample, shard=None)
    if differs := first.difference(here):
        raise DataFileError(f"{shards[0]}: not made by this Eyas: {differs}")
    return first, homes


def _join(parts: Sequence[DatasetPart], homes: dict[str, Path], out: Path, *, quiet: bool) -> None:
    done = 0
    with (
        frames_bar("merging", sum(part.frames for part in parts), quiet=quiet) as told,
        ThreadPoolExecutor() as threads,
    ):
        for part in parts:
            if read_facts(out / part.folder) is None:
                _take(homes[part.name] / part.folder, out / part.folder, threads)
            done += part.frames
            told(done)


def _take(source: Path, target: Path, threads: ThreadPoolExecutor) -> None:
    """Check all files of a part, and put them into the data set."""
    if read_facts(source) is None:
        raise DataFileError(f"{source}: the part is not complete")
    sums = read_checksums(source / CHECKSUMS)
    for name, digest in zip(sums, threads.map(_digest, map(source.joinpath, sums)), strict=True):
        if digest != sums[name]:
            raise DataFileError(
                f"{source / name}: not what was recorded: its SHA-256 is not that of {CHECKSUMS}"
            )
    with refusals(target):
        paths = [path.relative_to(source) for path in sorted(source.rglob("*"))]
        linked = next((source / name for name in paths if (source / name).is_symlink()), None)
        if linked is not None:  # it may lead to a file that nobody means to publish
            raise DataFileError(f"{linked}: a symbolic link, not a file of a shard")
        files = [name for name in paths if (source / name).is_file() and name.name != LOCK]
        # The file that says that the part is complete comes last.
        for path in sorted(files, key=lambda path: path.as_posix() == PART_FILE):
            _put(source / path, target / path)


def _digest(path: Path) -> str:
    try:
        return hashlib.sha256(path.read_bytes()).hexdigest()
    except OSError as error:
        raise DataFileError(f"{path}: cannot read: {error.strerror or error}") from error


def _put(source: Path, target: Path) -> None:
    target.parent.mkdir(parents=True, exist_ok=True)
    with atomic_path(target) as part:
        part.unlink(missing_ok=True)
        try:
            os.link(source, part)
        except OSError:  # another file system, or one without hard links
            shutil.copyfile(source, part)
