"""The folder of a recording: `DRONE<i>/episode<j>/NNNNNN.jpeg` and what describes it."""

import json
import os
import re
from collections.abc import Mapping, Sequence
from pathlib import Path

from eyas import __version__
from eyas.core.config import validated
from eyas.core.errors import ConfigError, DataFileError, OutputError
from eyas.core.files import PART_SUFFIX, refusals, write_atomic
from eyas.exports.labels import FrameLabel
from eyas.exports.mark import write_dir_info
from eyas.modes.video.episode import LABELS, MARK, MOVIE
from eyas.modes.video.lock import LOCK
from eyas.settings.config import EyasConfig
from eyas.settings.file import read_settings, save_settings
from eyas.settings.legacy.adapter import save_legacy

__all__ = ["VideoFolder", "check_folder", "open_folder"]

SETTINGS, LEGACY_SETTINGS, DIR_INFO = "config.json", "env_config.json", "dir_info.json"

VERSION = "version.json"
"""Which version of Eyas records: `{"eyas": "0.1.0"}`. Another one may draw other bytes."""


def _any_of(*names: str) -> str:
    """Return a pattern of these file names, and of any that is still being written."""
    return "|".join([re.escape(name) for name in names] + [rf"\.[\w.]+{re.escape(PART_SUFFIX)}"])


_OURS = re.compile(
    rf"(DRONE|CAR)\d+(/episode\d+(/(\d{{6,}}\.jpeg|{_any_of(MARK, LABELS, MOVIE)}))?)?"
    rf"|{_any_of(SETTINGS, LEGACY_SETTINGS, DIR_INFO, VERSION, LOCK)}"
)
"""Every path that a recording can hold, relative to its folder."""


class VideoFolder:
    """Where each file of a recording lies.

    Args:
        path: The recording's folder.
        config: What is recorded.
    """

    def __init__(self, path: Path, config: EyasConfig) -> None:
        self.path = path
        self._kind = config.tracker.kind.value.upper()

    def tracker_name(self, tracker: int) -> str:
        """Return the name of a tracker's folder."""
        return f"{self._kind}{tracker}"

    def episode(self, tracker: int, episode: int) -> Path:
        """Return the folder of an episode."""
        return self.path / self.tracker_name(tracker) / f"episode{episode}"

    def write_info(self, episodes: Sequence[Sequence[Sequence[FrameLabel]]]) -> None:
        """Write `dir_info.json`: the number of frames of each tracker's complete episodes.

        Raises:
            OutputError: The file system refused.
        """
        frames = {
            self.tracker_name(tracker): {f"episode{j}": len(labels) for j, labels in enumerate(own)}
            for tracker, own in enumerate(episodes)
        }
        write_dir_info(self.path / DIR_INFO, frames)


def check_folder(path: Path, config: EyasConfig, *, overwrite: bool, resume: bool) -> None:
    """Refuse a folder that cannot be recorded into; change nothing.

    Args:
        path: The folder; need not be there.
        config: What will be recorded.
        overwrite: Whether a recording that lies there may be deleted.
        resume: Whether a recording that lies there will be continued.

    Raises:
        OutputError: It is a file, or holds something, or what will be continued was recorded by
            another version of Eyas.
        ConfigError: The recording that lies there was made with other settings, or both
            `overwrite` and `resume` are asked for.
        DataFileError: The settings of the recording that lies there cannot be read.
    """
    if overwrite and resume:
        raise ConfigError("--overwrite and --resume exclude each other: delete, or continue")
    with refusals(path):
        if not path.exists():
            return
        if not path.is_dir():
            raise OutputError(f"{path}: is a file; name a folder")
        names = [inside.name for inside in path.iterdir()]
    used = any(name != LOCK and not name.endswith(PART_SUFFIX) for name in names)
    if used and overwrite:
        _require_recording(path)
    elif used and resume:
        _require_same_version(path)
        _require_same_settings(path, config)
    elif used:
        raise OutputError(
            f"{path}: not empty; continue its recording with --resume, replace it with"
            " --overwrite, or name another folder"
        )


def open_folder(path: Path, config: EyasConfig, *, overwrite: bool, resume: bool) -> VideoFolder:
    """Make a folder ready to record into, with the settings in it; `recording_lock` is held.

    Args:
        path: The folder; made if it is not there.
        config: What will be recorded.
        overwrite: Whether a recording that lies there is deleted.
        resume: Whether a recording that lies there is continued.

    Raises:
        OutputError: As `check_folder`, or the file system refused.
        ConfigError: As `check_folder`.
        DataFileError: As `check_folder`.
    """
    check_folder(path, config, overwrite=overwrite, resume=resume)
    with refusals(path):
        path.mkdir(parents=True, exist_ok=True)
        if overwrite:
            _delete_recording(path)
        _delete_parts(path)
    save_settings(config, path / SETTINGS)
    save_legacy(config, path / LEGACY_SETTINGS)
    write_atomic(path / VERSION, (json.dumps({"eyas": __version__}) + "\n").encode())
    return VideoFolder(path, config)


def _delete_parts(path: Path) -> None:
    """Delete what an interrupted run has left half-written."""
    for folder, _, names in os.walk(path):
        for name in names:
            part = Path(folder, name)
            if name.endswith(PART_SUFFIX) and _OURS.fullmatch(part.relative_to(path).as_posix()):
                part.unlink(missing_ok=True)


def _require_recording(path: Path) -> None:
    """Refuse to delete what is not a recording, or not only that."""
    if not (path / SETTINGS).is_file():
        raise OutputError(f"{path}: not deleted: it is no recording (it has no {SETTINGS})")
    for folder, folders, names in os.walk(path):
        for name in sorted(folders + names):
            inside = Path(folder, name).relative_to(path).as_posix()
            if not _OURS.fullmatch(inside) or Path(folder, name).is_symlink():
                raise OutputError(f"{path}: not deleted: '{inside}' is not part of a recording")


def _delete_recording(path: Path) -> None:
    for folder, folders, names in os.walk(path, topdown=False):
        for name in names:
            if Path(folder, name) not in (path / SETTINGS, path / LOCK):
                Path(folder, name).unlink()
        for name in folders:
            Path(folder, name).rmdir()
    # Last, so that a deletion that was interrupted can be asked for again.
    (path / SETTINGS).unlink(missing_ok=True)


def _require_same_version(path: Path) -> None:
    """Refuse to continue what another version began: one recording would hold two looks."""
    try:
        recorded = json.loads((path / VERSION).read_text())["eyas"]
    except (OSError, ValueError, TypeError, LookupError):
        recorded = "of an unknown version"
    if (path / SETTINGS).is_file() and recorded != __version__:
        raise OutputError(
            f"{path}: recorded by Eyas {recorded}, and this is {__version__}, which may draw"
            " otherwise; continue with that version, or start anew with --overwrite"
        )


def _require_same_settings(path: Path, config: EyasConfig) -> None:
    """Refuse to continue a recording that was begun with other settings."""
    settings = path / SETTINGS
    if not settings.is_file():
        raise OutputError(f"{path}: nothing to continue: not empty, and it has no {SETTINGS}")
    try:
        recorded = validated(EyasConfig, read_settings(settings))
    except (DataFileError, ConfigError):
        raise DataFileError(f"{settings}: cannot be read; start anew with --overwrite") from None
    was, asked = recorded.model_dump(mode="json"), config.model_dump(mode="json")
    difference = _first_difference(was, asked, "")
    if difference:
        raise ConfigError(f"{settings}: other settings than asked for: {difference}")


def _first_difference(recorded: object, asked: object, key: str) -> str:
    """Return a phrase for the first setting that differs, or nothing."""
    if not (isinstance(recorded, Mapping) and isinstance(asked, Mapping)):
        same = recorded == asked
        return "" if same else f"{key} was {json.dumps(recorded)}, is {json.dumps(asked)}"
    for name in [*asked, *(name for name in recorded if name not in asked)]:
        inner = f"{key}.{name}".lstrip(".")
        found = _first_difference(recorded.get(name), asked.get(name), inner)
        if found:
            return found
    return ""
