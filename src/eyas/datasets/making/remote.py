"""Data sets at a URL that fsspec knows, such as s3://; fsspec is imported here only.

A data set is made in a folder of the cache and put to its place part by part, `part.json` last; a
part that has it there is whole. `dataset.json` comes last of all.
"""

import hashlib
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from eyas.datasets.layout import MAKING_FILE, Plan, write_plan
from eyas.datasets.making.make import EXPORTED, Making
from eyas.datasets.making.parts import PART_FILE
from eyas.datasets.plan import Part
from eyas.engine.core.errors import ConfigError, MissingExtraError, OutputError
from eyas.engine.core.files import PART_SUFFIX
from eyas.engine.core.folder_lock import LOCK
from eyas.engine.recordings.recording import DATASET_FILE
from eyas.lanes.trusted import cache_folder

__all__ = ["Remote"]


class Remote:
    """The place of a data set behind a URL.

    Args:
        url: The URL of its folder.

    Raises:
        MissingExtraError: fsspec is not installed.
        ConfigError: It knows no such URLs.
    """

    def __init__(self, url: str) -> None:
        try:
            from fsspec.core import url_to_fs
        except ImportError as error:
            raise MissingExtraError(f"--out {url}", "exports") from error
        try:
            self._files, path = url_to_fs(url)
        except (ValueError, ImportError) as error:
            raise ConfigError(f"--out: {url!r} is not allowed: {_line(error)}") from error
        self._url, self._path = url, path.rstrip("/")
        digest = hashlib.sha256(url.encode()).hexdigest()[:16]
        self.root = cache_folder() / "datasets" / digest  # The folder in which it is made

    @contextmanager
    def scratch(self, plan: Plan, making: Making) -> Iterator[Path]:
        """Yield the folder in which the data set is made; it is deleted when all is in its place.

        What an interrupted run has put there is fetched, if it is not on this machine.

        Raises:
            OutputError: The place is not empty and not to be continued, or cannot be reached.
        """
        with self._told():
            self._files.invalidate_cache()
            there = {_name(path) for path in self._list()}
        if there and not making.resume:
            raise OutputError(
                f"{self._url}: not empty; continue its data set with --resume, or name another one"
            )
        if there and not there & {MAKING_FILE, DATASET_FILE}:
            raise OutputError(f"{self._url}: not a data set: it has no {MAKING_FILE}")
        if there:
            self._fetch(plan, there)
        else:
            shutil.rmtree(self.root, ignore_errors=True)
            self.root.mkdir(parents=True)
            write_plan(self.root, plan)
        with self._told():
            if DATASET_FILE not in there:
                self._put(MAKING_FILE)
        yield self.root
        shutil.rmtree(self.root, ignore_errors=True)

    def keep(self, part: Part | None) -> None:
        """Put a part to its place that is complete, or with None all that is not there yet.

        Raises:
            OutputError: It cannot be written.
        """
        with self._told():
            if part is not None:
                self._put_part(part.folder)
                return
            self._files.invalidate_cache()
            names = [path.relative_to(self.root) for path in sorted(self.root.rglob("*"))]
            left = [name.as_posix() for name in names if (self.root / name).is_file()]
            complete = set()
            for folder in [
                name[: -len(PART_FILE) - 1] for name in left if _name(name) == PART_FILE
            ]:
                if not self._files.exists(f"{self._path}/{folder}/{PART_FILE}"):
                    self._put_part(folder)
                complete.add(folder)
            for name in left:
                inside = any(name.startswith(f"{folder}/") for folder in complete)
                if not inside and _name(name) not in (LOCK, EXPORTED, DATASET_FILE):
                    self._put(name)
            self._put(DATASET_FILE)
            if self._files.exists(f"{self._path}/{MAKING_FILE}"):
                self._files.rm(f"{self._path}/{MAKING_FILE}")

    def _put_part(self, folder: str) -> None:
        inside = [path for path in sorted((self.root / folder).rglob("*")) if path.is_file()]
        own = [path for path in inside if path.name not in (PART_FILE, LOCK)]
        own = [path for path in own if not path.name.endswith(PART_SUFFIX)]
        names = [path.relative_to(self.root).as_posix() for path in own]
        self._files.put(list(map(str, own)), [f"{self._path}/{name}" for name in names])
        self._put(f"{folder}/{PART_FILE}")

    def _put(self, name: str) -> None:
        self._files.put_file(str(self.root / name), f"{self._path}/{name}")

    def _list(self) -> list[str]:
        try:
            return list(self._files.ls(self._path, detail=False))
        except FileNotFoundError:
            return []

    def _fetch(self, plan: Plan, there: set[str]) -> None:
        """Fetch the plan and the complete parts that are not on this machine."""
        with self._told():
            self.root.mkdir(parents=True, exist_ok=True)
            name = DATASET_FILE if DATASET_FILE in there else MAKING_FILE
            self._files.get_file(f"{self._path}/{name}", str(self.root / name))
            for part in plan.parts():
                here, marker = self.root / part.folder, f"{part.folder}/{PART_FILE}"
                if (self.root / marker).exists():
                    continue
                if name == MAKING_FILE and self._files.exists(f"{self._path}/{marker}"):
                    shutil.rmtree(here, ignore_errors=True)
                    here.mkdir(parents=True)
                    for path in self._files.find(f"{self._path}/{part.folder}"):
                        inside = path[len(self._path) + 1 :]
                        if _name(inside) != PART_FILE:
                            (self.root / inside).parent.mkdir(parents=True, exist_ok=True)
                            self._files.get_file(path, str(self.root / inside))
                    self._files.get_file(f"{self._path}/{marker}", str(self.root / marker))

    @contextmanager
    def _told(self) -> Iterator[None]:
        """Turn errors of the file system, of whatever kind, into one line."""
        try:
            yield
        except (OutputError, KeyboardInterrupt):
            raise
        except Exception as error:  # each file system of fsspec has its own kinds
            raise OutputError(f"{self._url}: cannot read or write: {_line(error)}") from error


def _name(path: Any) -> str:  # noqa: ANN401  # fsspec's, a text
    return str(path).rstrip("/").rpartition("/")[2]


def _line(error: Exception) -> str:
    return " ".join(str(error).split())[:300] or type(error).__name__
