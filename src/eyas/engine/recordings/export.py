"""The run of an export: episode by episode, so that one that was interrupted goes on."""

import hashlib
import json
import logging
import re
import shutil
from collections.abc import Callable, Iterator, Mapping, Sequence
from collections.abc import Set as AbstractSet
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from eyas.engine.core.config import shown
from eyas.engine.core.decoding import read_json
from eyas.engine.core.errors import ConfigError, DataFileError, OutputError
from eyas.engine.core.files import PART_SUFFIX, read_limited, refusals, write_atomic
from eyas.engine.core.folder_lock import LOCK, folder_lock
from eyas.engine.core.identity.build import this_build
from eyas.engine.core.installed import installed_version
from eyas.engine.core.own_code import left_out
from eyas.engine.exports.checksums import (
    CHECKSUMS,
    SEALED,
    damaged_files,
    read_checksums,
    seal_folder,
)
from eyas.engine.recordings.format import FORMATS, KEPT, SETTING, Exported, ExportJob, Format
from eyas.engine.recordings.recording import (
    DATASET_FILE,
    OF_EPISODES,
    RecordedEpisode,
    Recording,
    from_first_sight,
)

_LOG = logging.getLogger("eyas")
EXPORTS = "exports"  # Folder of the exports in that of a recording or data set
FINISHED, GROWING = "export.json", ".export.json"
"""Files with the identity of an export: when it is complete, and while it is in progress."""

_ASIDE = (FINISHED, GROWING, KEPT, ".done", LOCK)  # Names that are no part of a finished export
DONE = ".done"  # Names of the episodes that are written completely, a line each

Progress = Callable[[int], None]  # Gets the number of exported frames


@dataclass(frozen=True, slots=True)
class ExportOptions:
    """Options of an export, see `ExportJob`."""

    copies: bool = False
    least_side: int = 1
    least_visible: float = 0.0
    ignore_parked: bool = False
    resume: bool = False  # Whether an interrupted export in the folder is continued
    overwrite: bool = False  # Whether an export in the folder is deleted first


def export(
    recording: Recording,
    name: str,
    folder: Path,
    options: ExportOptions,
    progress: Progress = lambda frames: None,
) -> None:
    """Export a recording or a data set in one format.

    The same recording and options give the same bytes, also when the export was interrupted.

    Args:
        recording: What is exported.
        name: The format: a name of `FORMATS`, or `package.module:Class`.
        folder: The folder of the export.
        options: What was chosen.
        progress: Gets the number of frames that are done, after each episode.

    Raises:
        ConfigError: There is no such format.
        DataFileError: The recording is not whole, or lacks what the format needs.
        OutputError: The folder is in use, not empty, or cannot be written.
        MissingExtraError: The format needs a library that is not installed.
    """
    make = _format_of(name)
    require_outputs(recording, name, make)
    job = ExportJob(
        folder,
        _name_of(recording),
        copies=options.copies,
        least_side=options.least_side,
        least_visible=options.least_visible,
        ignore_parked=options.ignore_parked,
    )
    form = make(job)
    with folder_lock(folder, "exporting into it"):
        if _open(folder, _identity(recording, name, options), options):
            form.finish(_add_all(form, recording, folder, progress))
            _finish(folder, _identity(recording, name, options))
        else:
            progress(recording.frame_count)
        # Last, so that an export which is killed here has all that it needs, or is finished.
        shutil.rmtree(folder / KEPT, ignore_errors=True)
        (folder / DONE).unlink(missing_ok=True)


def add_episodes(folder: Path, named: str, name: str, episodes: Sequence[RecordedEpisode]) -> None:
    """Put episodes into the export of a data set that is being made; they are known to be whole.

    Raises:
        EyasError: As `export`.
    """
    form = _format_of(name)(ExportJob(folder, named))
    for episode in episodes:
        shown = _shown(form, episode)
        if shown is not None:
            form.add(shown)


def finish_export(folder: Path, named: str, name: str, recording: Recording) -> None:
    """Complete the export of a data set, all episodes of which have been added.

    Raises:
        EyasError: As `export`.
    """
    form = _format_of(name)(ExportJob(folder, named))
    exported = []
    for episode in recording.episodes:
        shown = _shown(form, episode)
        if shown is not None:
            exported.append(Exported(episode.name, episode.split, len(shown)))
        episode.__dict__.pop("labels", None)
    form.finish(exported)
    shutil.rmtree(folder / KEPT, ignore_errors=True)
    _finish(folder, {**_identity(recording, name, ExportOptions()), "recording": named})


def _finish(folder: Path, identity: dict[str, Any]) -> None:
    """Write the file that says that an export is complete."""
    known = {**identity, SEALED: seal_folder(folder, _ASIDE)}
    write_atomic(folder / FINISHED, (json.dumps(known, indent=1) + "\n").encode())
    with refusals(folder):
        (folder / GROWING).unlink(missing_ok=True)


def damaged_export(folder: Path) -> Path | None:
    """Return a file of a finished export that has changed since; None if none has."""
    return next(damaged_files(folder, _read(folder / FINISHED).get(SEALED)), None)


def require_outputs(recording: Recording, name: str, make: type[Format]) -> None:
    """Refuse a recording that lacks what a format needs.

    Raises:
        DataFileError: The recording has no episodes, or an episode lacks something.
    """
    if not recording.episodes:
        raise DataFileError(f"{recording.folder}: has no episodes")
    for episode in recording.episodes:
        for output in sorted(make.needs):
            has = episode.has(output) or (output == "jpeg" and episode.has("png"))
            if not has:
                raise DataFileError(
                    f"{episode.folder}: the format {name!r} needs the writer {output!r}; record "
                    f"with video.writers = {json.dumps(sorted(make.needs))}"
                )


def _format_of(name: str) -> type[Format]:
    found: type[Format] = FORMATS.get(name)
    if missing := left_out(found, ("needs", "add", "finish")):
        raise ConfigError(f"{SETTING}: {name!r} is not a format: it has no '{missing[0]}'")
    return found


def _name_of(recording: Recording) -> str:
    """Return the name of a data set, or that of a recording's folder."""
    recipe = _read(recording.folder / DATASET_FILE).get("recipe")
    named = recipe.get("name") if isinstance(recipe, dict) else None
    if isinstance(named, str) and re.fullmatch(r"\w[\w.-]*", named):
        return named
    return recording.folder.resolve().name or "recording"


def _identity(recording: Recording, name: str, options: ExportOptions) -> dict[str, Any]:
    """Return what an export is of; two that have the same are the same to the byte."""
    sums = hashlib.sha256()
    for folder in dict.fromkeys(episode.folder.parent.parent for episode in recording.episodes):
        sums.update(read_limited(folder / CHECKSUMS, 1 << 30))
    return {
        "format": name,
        "recording": _name_of(recording),
        "checksums": sums.hexdigest(),
        "pictures": "copied" if options.copies else "linked",
        "least_side": options.least_side,
        "least_visible": options.least_visible,
        "ignore_parked": options.ignore_parked,
        "eyas": installed_version(),
        "build_id": this_build().id,
    }


def _open(folder: Path, identity: dict[str, Any], options: ExportOptions) -> bool:
    """Prepare the folder; return whether something is left to do. `OutputError` if it is not empty,
    or not of the same export.
    """
    with refusals(folder):
        names = {inside.name for inside in folder.iterdir()} - {LOCK}
    if names and options.overwrite:
        if not names & {FINISHED, GROWING}:
            raise OutputError(f"{folder}: not deleted: it is not an export (it has no {FINISHED})")
        _empty(folder)
        names = set()
    if names and options.resume:
        known = FINISHED if FINISHED in names else GROWING
        found = _read(folder / known)
        different = [key for key in identity if found.get(key) != identity[key]]
        if different:
            key = different[0]
            raise OutputError(
                f"{folder}: not continued: its {key} was {shown(found.get(key))}, is "
                f"{shown(identity[key])}; start again with --overwrite"
            )
        _delete_parts(folder)
        damaged = damaged_export(folder) if known == FINISHED else None
        if damaged is None:
            return known == GROWING
        _LOG.warning("%s: not as it was exported, so all is exported again", damaged)
        with refusals(folder):
            (folder / DONE).unlink(missing_ok=True)
            (folder / FINISHED).replace(folder / GROWING)
        return True
    if names:
        raise OutputError(
            f"{folder}: not empty; continue its export with --resume, replace it with --overwrite,"
            " or name another folder"
        )
    write_atomic(folder / GROWING, (json.dumps(identity, indent=1) + "\n").encode())
    return True


def _read(path: Path) -> dict[str, Any]:
    try:
        found = read_json(path, 1 << 28)
    except DataFileError:
        return {}
    return found if isinstance(found, dict) else {}


def _empty(folder: Path) -> None:
    with refusals(folder):
        for inside in sorted(folder.iterdir(), key=lambda path: path.name in (FINISHED, GROWING)):
            if inside.name == LOCK:
                continue
            if inside.is_dir() and not inside.is_symlink():
                shutil.rmtree(inside)
            else:
                inside.unlink()


def _delete_parts(folder: Path) -> None:
    for part in folder.rglob(f".*{PART_SUFFIX}"):
        with suppress(FileNotFoundError):
            part.unlink()


def _add_all(
    form: Format, recording: Recording, folder: Path, progress: Progress
) -> list[Exported]:
    """Export all episodes but those that an earlier run has written completely."""
    done, sums = _done(folder / DONE), _Checksums()
    exported, frames = [], 0
    with refusals(folder), (folder / DONE).open("ab") as finished:
        # A line that a kill has cut off must not spoil the next one.
        finished.write(b"\n" * bool(finished.tell()))
        for episode in recording.episodes:
            count = len(episode)
            shown = _shown(form, episode)
            if shown is None:
                _LOG.warning("%s: left out: its target is never visible", episode.name)
            elif episode.name not in done:
                sums.require_whole(episode, form.needs)
                form.add(shown)
                finished.write(f"{episode.name}\n".encode())
                finished.flush()
            if shown is not None:
                exported.append(Exported(episode.name, episode.split or "train", len(shown)))
            frames += count
            episode.__dict__.pop("labels", None)  # those of one episode are in memory at a time
            progress(frames)
    return exported


def _shown(form: Format, episode: RecordedEpisode) -> RecordedEpisode | None:
    """Return what a format shows of an episode; None: nothing."""
    return from_first_sight(episode) if getattr(form, "first_sight", False) else episode


def _done(path: Path) -> set[str]:
    try:
        return set(path.read_text().split("\n")[:-1])
    except FileNotFoundError:
        return set()


class _Checksums:
    """Checksums of the files of recordings; one recording at a time, as a data set may have a
    million files.
    """

    def __init__(self) -> None:
        self._run: Path | None = None
        self._sums: dict[str, dict[str, str]] = {}

    def require_whole(self, episode: RecordedEpisode, needs: AbstractSet[str]) -> None:
        """Refuse an episode whose files are not those of the recording's checksums, which must
        name all that a format is made of. Films and arrays are not compared: they are large.
        """
        run = episode.folder.parent.parent
        if run != self._run:
            self._run, self._sums = run, _by_folder(read_checksums(run / CHECKSUMS))
        inside = episode.folder.relative_to(run).as_posix()
        sums = self._sums.get(inside, {})
        for path in _needed(episode, needs):
            if path.relative_to(run).as_posix() not in sums:
                raise DataFileError(f"{path}: not what was recorded: {CHECKSUMS} does not name it")
        for name, digest in sums.items():
            path = run / name
            if path.suffix in (".mp4", ".webp", ".npz"):
                continue
            if hashlib.sha256(read_limited(path, 1 << 30)).hexdigest() != digest:
                raise DataFileError(
                    f"{path}: not what was recorded: its SHA-256 is not that of {CHECKSUMS}"
                )


def _needed(episode: RecordedEpisode, needs: AbstractSet[str]) -> Iterator[Path]:
    for output in sorted(needs):
        if output in OF_EPISODES:
            yield episode.folder / OF_EPISODES[output]
        else:
            kind = episode.picture_kind if output == "jpeg" else output
            yield from (episode.file(kind, number) for number in range(len(episode)))


def _by_folder(sums: Mapping[str, str]) -> dict[str, dict[str, str]]:
    """Return the checksums of each episode's files by its folder, `<tracker>/episode<j>`."""
    folders: dict[str, dict[str, str]] = {}
    for name, digest in sums.items():
        folder = "/".join(name.split("/")[:2])
        folders.setdefault(folder, {})[name] = digest
    return folders


def exports_folder(
    recording: Path,  # The folder of the recording
    name: str,  # The format
    out: Path | None,  # Folder of all exports; None: the recording's `exports`
) -> Path:
    """Return the folder of an export, by default in that of the recording."""
    return (out or recording / EXPORTS) / name.rpartition(":")[2].lower()


def formats_needs(names: Sequence[str]) -> list[str]:
    """Return the writers of whose files these formats are made."""
    return list(
        dict.fromkeys(output for name in names for output in sorted(_format_of(name).needs))
    )
