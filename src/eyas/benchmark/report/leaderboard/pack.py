"""One file with all that a leaderboard needs of an evaluation, to be sent in."""

import io
import json
import zipfile
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from importlib.util import find_spec
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import NamedTuple

from eyas.benchmark.evaluation import TIMING
from eyas.benchmark.policies.table import FILES
from eyas.benchmark.records.result import EPISODES, RESULT, STAMP
from eyas.benchmark.report.films import FOLDER, film
from eyas.benchmark.report.leaderboard.submission import CARD, complete_run, read_card
from eyas.benchmark.report.leaderboard.verify import holds_code
from eyas.engine.core.errors import DataFileError
from eyas.engine.core.files import read_limited, write_atomic

_LARGEST = 1 << 31  # Largest size of a file of an entry [bytes]
_UNPACKED = 1 << 29  # Largest size of what is sent in, and of all files in it [bytes]
_MOST_FILES = 16
_DAMAGED = (ValueError, RuntimeError, OSError, EOFError, zipfile.BadZipFile, zlib.error)
"""What reading raises where a zip file is another or damaged."""

_MEDIAN = f"{FOLDER}/median.mp4"


class Packed(NamedTuple):
    """The file of an entry."""

    file: Path
    about: str  # A line on what it holds and lacks


def pack(folder: Path, out: Path | None = None) -> Packed:
    """Write the zip file of an entry.

    It holds the records, the card, the policy's file if it has one, and a film of the median flight
    where PyAV is installed. A card that is missing is made, with the policy's name.

    Args:
        folder: Folder of a finished evaluation.
        out: The file; None: `<folder>.zip`.

    Raises:
        EyasError: The evaluation is not finished or contradicts itself, its card is none, or its
            policy is not there.
    """
    stamp, _, records = complete_run(folder)
    plan, notes = stamp.plan, []
    if read_card(folder) is None:
        card = {"name": Path(plan.policy).stem}
        write_atomic(folder / CARD, (json.dumps(card) + "\n").encode())
        notes.append(f"{folder / CARD} made: add authors, link, trained_on and license to it")
    beside = folder / Path(plan.policy).name
    if beside.suffix in FILES and beside.is_file():
        plan = plan.model_copy(update={"policy": str(beside)})
    policy = plan.policy
    names = [STAMP, EPISODES, RESULT, CARD]
    names += [TIMING] if (folder / TIMING).is_file() else []
    files = {name: folder / name for name in names}
    if Path(policy).suffix in FILES:
        files[Path(policy).name] = Path(policy)
        if holds_code(policy):
            notes.append(f"'{Path(policy).name}' holds code: others verify it only by --trust")
    elif holds_code(policy):
        notes.append("its policy is code, which is not in it: others cannot verify it; send a file")
    if find_spec("av") is None:
        notes.append("without a film (extra video)")
    else:
        if not (folder / _MEDIAN).is_file():
            film(folder, plan, records, wanted=("median",))
        files[_MEDIAN] = folder / _MEDIAN
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, path in files.items():
            archive.writestr(zipfile.ZipInfo(name), read_limited(path, _LARGEST))
    target = out or folder.with_name(f"{folder.name}.zip")
    write_atomic(target, packed.getvalue())
    made = f"{len(records)} episodes of '{stamp.plan.protocol}' in {target}"
    return Packed(target, "; ".join([made, *notes]))


@contextmanager
def unpacked(path: Path) -> Iterator[Path]:
    """Yield a folder with what the zip file of an entry holds: the files that `pack` writes.

    Other files are refused, so that none can lie outside the folder.

    Raises:
        DataFileError: It cannot be read, or is no such file.
    """
    with TemporaryDirectory() as made:
        folder = Path(made) / path.stem
        (folder / FOLDER).mkdir(parents=True)
        try:
            for name, content in _files_in(read_limited(path, _UNPACKED)):
                (folder / name).write_bytes(content)
        except _DAMAGED as error:
            raise DataFileError(f"{path}: not the file of an entry: {error}") from None
        yield folder


def _files_in(data: bytes) -> Iterator[tuple[str, bytes]]:
    with zipfile.ZipFile(io.BytesIO(data)) as archive:
        members = archive.infolist()
        size = sum(member.file_size for member in members)
        if len(members) > _MOST_FILES or size > _UNPACKED:
            raise ValueError(f"{len(members)} files of {size} bytes: too many, or too large")
        if len({member.filename for member in members}) < len(members):
            raise ValueError("a file is there twice")
        for member in members:
            name = member.filename
            policy = Path(name).suffix in FILES and not {"/", "\\", ":"} & set(name)
            if name not in (STAMP, EPISODES, RESULT, CARD, TIMING, _MEDIAN) and not policy:
                raise ValueError(f"{name!r:.80} is no file of an entry")
            with archive.open(member) as file:
                content = file.read(member.file_size + 1)  # never more, whatever there is
            if len(content) != member.file_size:
                raise ValueError(f"{name}: cut off")
            yield name, content
