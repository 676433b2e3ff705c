"""The folder of a recording: `DRONE<i>/episode<j>/NNNNNN.jpeg` and its settings."""

import json
import os
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import asdict
from pathlib import Path
from typing import Any

from eyas.engine.core.config import validated
from eyas.engine.core.decoding import read_json
from eyas.engine.core.errors import ConfigError, DataFileError, OutputError
from eyas.engine.core.files import PART_SUFFIX, refusals, write_atomic
from eyas.engine.core.folder_lock import LOCK
from eyas.engine.core.identity.build import Build, this_build
from eyas.engine.core.installed import installed_version
from eyas.engine.core.optics.lens import NO_LENS, Lens, camera_matrix
from eyas.engine.exports.checksums import CHECKSUMS, GROWING
from eyas.engine.exports.registry import WRITERS, chosen_writers
from eyas.engine.exports.writer import Episode, Files, Run, joined
from eyas.engine.settings.config import EyasConfig
from eyas.engine.settings.dialect import dialect
from eyas.engine.settings.file import read_settings, save_settings
from eyas.engine.video.episode import RecordedPaths, paths_below
from eyas.engine.video.formats import writers_in
from eyas.engine.world.maps import MAPS
from eyas.engine.world.maps.recipe import ATTRIBUTION_FILE

SETTINGS = "config.json"
ORIGIN = "version.json"
"""Version and build of Eyas and the files of the writers: `{"eyas": "0.1.0", "build_id": "...",
"build": {...}, "files": {...}, "seed": 0}`. The build, since another one may draw different
pictures; the files, so that `--overwrite` can delete them even if the package of a user's own
writer is no longer installed."""

STEP_LOGS = ("DRONE{:d}.log", "CAR{:d}.log")
"""Names of the logs in the folder of a recording, outside of the trackers' folders."""

_NOT_PICTURED = ("learning",)  # Houses that have no part in a recording
_OF_DIALECT = (found.file,) if (found := dialect()) else ()
_OWN = (SETTINGS, *_OF_DIALECT, ORIGIN, CHECKSUMS, GROWING, ATTRIBUTION_FILE, LOCK)
_FIRST = frozenset((ORIGIN, ATTRIBUTION_FILE))
"""Files that are written before the settings: a folder that has no others was broken off there, and
is begun anew when it is to be continued."""


class VideoFolder:
    """The folders and the writers of the episodes of a recording.

    Attributes:
        path: The recording's folder.
        trackers: Names of the trackers and of their folders.
        writers: One for each format.
    """

    def __init__(self, path: Path, config: EyasConfig) -> None:
        self.path = path
        self._fps = config.video.fps
        self._camera = config.camera
        kind = config.tracker.original_name
        self.trackers = tuple(f"{kind}{tracker}" for tracker in range(config.video.channels))
        video = config.video
        run = Run(
            path,
            self.trackers,
            config,
            video.target_direction,
            video.jpeg_quality,
            video.depth_unit,
        )
        self.writers = tuple(writer(run) for writer in chosen_writers(writers_in(video.writers)))

    def episode(
        self, tracker: int, number: int, field_of_view: float, lens: Lens = NO_LENS
    ) -> Episode:
        """Return the description of an episode; its camera's field of view is horizontal [rad]."""
        name, camera = self.trackers[tracker], self._camera
        return Episode(
            folder=self.path / name / f"episode{number}",
            tracker=name,
            number=number,
            width=camera.width,
            height=camera.height,
            intrinsics=camera_matrix(lens, camera.width, camera.height, field_of_view),
            fps=self._fps,
        )


def check_folder(path: Path, config: EyasConfig, *, overwrite: bool, resume: bool) -> None:
    """Refuse a folder that cannot be recorded into; change nothing.

    Args:
        path: The folder; it need not exist.
        config: The settings.
        overwrite: Whether an existing recording may be deleted.
        resume: Whether an existing recording will be continued.

    Raises:
        OutputError: It is a file, or not empty, or the recording to continue was made by another
            build of Eyas.
        ConfigError: The existing recording was made with other settings, or both `overwrite`
            and `resume` are given.
        DataFileError: The settings of the existing recording cannot be read.
    """
    if overwrite and resume:
        raise ConfigError("--overwrite and --resume cannot be used together")
    with refusals(path):
        if not path.exists():
            return
        if not path.is_dir():
            raise OutputError(f"{path}: is a file; name a folder")
        names = {inside.name for inside in path.iterdir()} - {LOCK}
    used = {name for name in names if not name.endswith(PART_SUFFIX)}
    if used and overwrite:
        _require_recording(path, _contents(path, config))
    elif used and resume:
        _require_plain(path)
        _require_same_build(path)
        if not used <= _FIRST:
            _require_same_settings(path, config)
    elif used:
        raise OutputError(
            f"{path}: not empty; continue its recording with --resume, replace it with"
            " --overwrite, or name another folder"
        )


def recorded_seed(path: Path) -> int | None:
    """Return the seed of the recording in a folder; None if it cannot be read there."""
    with suppress(DataFileError):
        seed = read_settings(path / SETTINGS).get("seed")
        return seed if isinstance(seed, int) else None
    return None


def open_folder(path: Path, config: EyasConfig, *, overwrite: bool, resume: bool) -> VideoFolder:
    """Prepare a folder for recording and write the settings; call it under `folder_lock`.

    Args:
        path: The folder; made if it does not exist.
        config: The settings.
        overwrite: Whether an existing recording is deleted.
        resume: Whether an existing recording is continued.

    Raises:
        OutputError: As `check_folder`, or writing failed.
        ConfigError: As `check_folder`.
        DataFileError: As `check_folder`.
    """
    check_folder(path, config, overwrite=overwrite, resume=resume)
    with refusals(path):
        path.mkdir(parents=True, exist_ok=True)
        if overwrite:
            _delete_recording(path)
        _delete_parts(path, _contents(path, config))
    folder = VideoFolder(path, config)
    files = joined(writer.files for writer in folder.writers)
    build = this_build()
    origin = {
        **{"eyas": installed_version(), "build_id": build.id, "build": build.model_dump()},
        "files": asdict(files),
        "seed": config.seed,
    }
    write_atomic(path / ORIGIN, (json.dumps(origin) + "\n").encode())
    notice = MAPS.get(config.world.map).attribution()
    if notice:
        write_atomic(path / ATTRIBUTION_FILE, notice.encode())
    save_settings(config, path / SETTINGS)
    other = dialect()
    if other is not None:
        other.save(config, path / other.file)
    return folder


def _contents(path: Path, config: EyasConfig) -> RecordedPaths:
    """Return the paths of a recording with these settings, and of the existing one."""
    names = dict.fromkeys((*WRITERS.built_in, *writers_in(config.video.writers)))
    files = [WRITERS.get(name).files for name in names]
    with suppress(DataFileError, ValueError, TypeError, KeyError):
        recorded = _origin(path)["files"]
        files.append(Files(**{kind: tuple(recorded[kind]) for kind in recorded}))
    return RecordedPaths(joined(files), [*_OWN, *STEP_LOGS])


def _origin(path: Path) -> Any:  # noqa: ANN401  # JSON, of anyone
    return read_json(path / ORIGIN, 1 << 20)


def _require_plain(path: Path) -> None:
    """Refuse a folder with links: what is written and deleted below one lies elsewhere."""
    for inside, found in paths_below(path):
        if found.is_symlink() or not (found.is_file() or found.is_dir()):
            raise OutputError(
                f"{path}: not continued: {inside!r} is a link or a device; a recording has none"
            )


def _delete_parts(path: Path, contents: RecordedPaths) -> None:
    """Delete the unfinished files of an interrupted run."""
    for inside, part in list(paths_below(path)):
        if part.name.endswith(PART_SUFFIX) and contents.in_run(inside):
            part.unlink(missing_ok=True)


def _require_recording(path: Path, contents: RecordedPaths) -> None:
    """Refuse to delete a folder that is not a recording or holds other files."""
    if not (path / SETTINGS).is_file():
        raise OutputError(f"{path}: not deleted: it is not a recording (it has no {SETTINGS})")
    for inside, found in paths_below(path):
        if not contents.in_run(inside) or found.is_symlink():
            raise OutputError(f"{path}: not deleted: '{inside}' is not part of a recording")


def _delete_recording(path: Path) -> None:
    # These last, so that an interrupted deletion can be repeated.
    last = (path / ORIGIN, path / SETTINGS)
    for folder, folders, names in os.walk(path, topdown=False):
        for name in names:
            if Path(folder, name) not in (*last, path / LOCK):
                Path(folder, name).unlink()
        for name in folders:
            Path(folder, name).rmdir()
    for kept in last:
        kept.unlink(missing_ok=True)


def _require_same_build(path: Path) -> None:
    """Refuse to continue a recording of another build of Eyas, whose pictures may differ."""
    if not (path / SETTINGS).is_file() and not (path / ORIGIN).is_file():
        return  # not a recording, and refused as such
    try:
        origin = _origin(path)
        version, build = origin["eyas"], Build(**origin["build"])
    except (DataFileError, ConfigError, ValueError, TypeError, LookupError):
        by = "of an unknown version"
    else:
        differs = build.difference(this_build(), without=_NOT_PICTURED)
        if not differs:
            return
        by = f"{version!s:.40}, build {build.id}, which differs from this one in {differs}"
    raise OutputError(
        f"{path}: recorded by Eyas {by}; pictures may differ, so continue with that build, or "
        "start again with --overwrite"
    )


def _require_same_settings(path: Path, config: EyasConfig) -> None:
    """Refuse to continue a recording that was begun with other settings."""
    settings = path / SETTINGS
    if not settings.is_file():
        raise OutputError(f"{path}: not a recording: it has no {SETTINGS}")
    try:
        recorded = validated(EyasConfig, read_settings(settings))
    except (DataFileError, ConfigError):
        raise DataFileError(f"{settings}: cannot be read; start again with --overwrite") from None
    # Values without effect need not be the same.
    was = recorded.model_dump(mode="json", exclude={"original"})
    asked = config.model_dump(mode="json", exclude={"original"})
    difference = _first_difference(was, asked, "")
    if difference:
        raise ConfigError(
            f"{settings}: the recording was made with different settings: {difference}"
        )


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
