"""The mark that a verifier leaves beside records: which they were, and that this machine set it.

Whoever sends in a folder can write any file in it, so that the mark is signed with a key that only
the verifier's machine has.
"""

import hmac
import os
import secrets
from hashlib import sha256
from pathlib import Path

from platformdirs import user_data_dir

from eyas.benchmark.records.result import EPISODES, STAMP
from eyas.benchmark.report.leaderboard.fresh import FreshFigure
from eyas.engine.core.config import Config, validated
from eyas.engine.core.decoding import read_json
from eyas.engine.core.errors import EyasError
from eyas.engine.core.files import read_limited, refusals, user_path

MARK = "verified.json"  # The file

KEY_VARIABLE = "EYAS_VERIFIER_KEY"
"""Environment variable: file with the key; by default one of the user's."""

_LARGEST = 1 << 31  # Largest size of a file of records [bytes]


class Mark(Config):
    """What was flown again, with equal results."""

    build: str
    """Build of Eyas that has flown it again."""
    seed: int
    """Seed of the choice of episodes."""
    flown: tuple[str, ...]
    """Names of the episodes that were flown again."""
    episodes: int
    """Number of the evaluation's episodes."""
    content: str
    """Hash of plan and records, see `content_hash`."""
    fresh: FreshFigure | None = None
    """What the policy has reached in episodes of secret seeds; None: it has not flown any."""
    signature: str = ""


def content_hash(folder: Path) -> str:
    """Return the hash of an evaluation's plan and records.

    Raises:
        DataFileError: A file cannot be read.
    """
    digest = sha256()
    for name in (STAMP, EPISODES):
        content = read_limited(folder / name, _LARGEST)
        digest.update(f"{name} {len(content)} ".encode() + content)
    return digest.hexdigest()


def signed(mark: Mark) -> Mark:
    """Return a mark with this machine's signature; the key is made if there is none.

    Raises:
        EyasError: The key cannot be read or written.
    """
    return mark.model_copy(update={"signature": _signature(mark, _key(make=True))})


def fitting_mark(folder: Path) -> Mark | None:
    """Return the mark that this machine has set on what the folder holds now; None without one."""
    try:
        mark = validated(Mark, read_json(folder / MARK, _LARGEST))
        own = _signature(mark, _key(make=False))
        known = hmac.compare_digest(own.encode(), mark.signature.encode())
        return mark if known and mark.content == content_hash(folder) else None
    except (EyasError, AttributeError, ValueError):
        return None


def _signature(mark: Mark, key: bytes) -> str:
    content = mark.model_copy(update={"signature": ""}).model_dump_json()
    return hmac.new(key, content.encode(), sha256).hexdigest()


def _key(*, make: bool) -> bytes:
    said = os.environ.get(KEY_VARIABLE)
    path = user_path(said) if said else Path(user_data_dir("eyas")) / "verifier.key"
    if make and not path.exists():
        with refusals(path):
            path.parent.mkdir(parents=True, exist_ok=True)
            # Not readable by others from the first moment on.
            with open(os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600), "wb") as file:
                file.write(secrets.token_bytes(32))
    return read_limited(path, 1 << 12)
