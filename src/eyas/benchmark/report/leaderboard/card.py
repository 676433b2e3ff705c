"""The model card of an entry: who it is from, and what it was taught on."""

from pathlib import Path
from typing import Annotated

from pydantic import AfterValidator, Field

from eyas.engine.core.config import Config, validated
from eyas.engine.core.decoding import read_json
from eyas.engine.core.errors import ConfigError, DataFileError

__all__ = ["CARD", "ModelCard", "read_card"]

CARD = "card.json"  # The file, beside the records of an evaluation

_LARGEST = 1 << 20  # Largest size of the file [bytes]


def _is_link(text: str) -> str:
    if not text.startswith(("https://", "http://")) or not text.isprintable() or " " in text:
        raise ValueError("must be an address that begins with https:// or http://")
    return text


Line = Annotated[str, Field(min_length=1, max_length=300)]
Link = Annotated[str, Field(max_length=500), AfterValidator(_is_link)]


class ModelCard(Config):
    """What an entry says of itself; a page shows it as text, and nothing of it is checked."""

    name: Line
    """What the policy is called."""
    authors: tuple[Line, ...] = ()
    link: Link | None = None
    """Where code, weights or a paper are."""
    trained_on: Line | None = None
    """The maps, recordings or films of training."""
    license: Line | None = None
    """Of the weights, for example `MIT`."""
    remarks: Annotated[str, Field(max_length=2000)] | None = None


def read_card(folder: Path) -> ModelCard | None:
    """Return the card of an evaluation; None if it has none.

    Raises:
        DataFileError: The file cannot be read, or is no card: one line with the wrong key.
    """
    path = folder / CARD
    if not path.exists():
        return None
    try:
        values = read_json(path, _LARGEST, "a card")
        if not isinstance(values, dict):
            raise ValueError("not a JSON object")
        return validated(ModelCard, values)
    except (ValueError, ConfigError) as error:
        raise DataFileError(f"{path}: not a card: {error}") from None
