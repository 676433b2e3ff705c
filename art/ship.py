"""Draws what ships as data, and packs it.

    python -m art.ship                    # after a change in `art`: all that it makes, anew
    python -m art.ship --check            # whether what ships is what is made; nothing is written
    python -m art.ship textures           # some of it

Run it in the root of a clone.
"""

import argparse
import importlib
import re
from pathlib import Path
from types import ModuleType

from art.cars.parked import pack_parked
from art.catalogue import pack_models
from art.textures.library import pack_textures

SHIPMENTS = {
    "models": ("eyas.engine.targets.shapes", pack_models),
    "parked": ("eyas.maps.street.parked_cars", pack_parked),
    "textures": ("eyas.maps.textures.shipped", pack_textures),
}
"""The module that reads each, with its digest as `SHA256`, and what makes its files and digest."""


def main() -> None:
    """Pack what the command names, or compare it."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("names", nargs="*", metavar="NAME", help=f"of {', '.join(SHIPMENTS)}")
    parser.add_argument("--check", action="store_true", help="write nothing")
    options = parser.parse_args()
    if unknown := set(options.names) - SHIPMENTS.keys():
        parser.error(f"{', '.join(sorted(unknown))}: unknown; known: {', '.join(SHIPMENTS)}")
    stale = [name for name in options.names or SHIPMENTS if not _is_shipped(name, options.check)]
    if stale:
        raise SystemExit(f"run `python -m art.ship {' '.join(stale)}`")


def _is_shipped(name: str, check: bool) -> bool:
    """Return whether what ships is what is made; unless `check`, make it so."""
    module, pack = SHIPMENTS[name]
    reader = importlib.import_module(module)
    files, digest = pack()
    if check:
        return bool(digest == reader.SHA256)
    for path, content in files.items():
        path.write_bytes(content)
    _note(reader, digest)
    return True


def _note(reader: ModuleType, digest: str) -> None:
    """Write a digest into the source of the module that reads the data."""
    source = Path(reader.__file__ or "")
    source.write_text(re.sub(r'(?m)^SHA256 = ".*"$', f'SHA256 = "{digest}"', source.read_text()))


if __name__ == "__main__":
    main()
