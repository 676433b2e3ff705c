"""Paint all textures, and pack them as they ship.

python tools/ship_textures.py          # after a change of a painter in `src/eyas/maps/textures`
python tools/ship_textures.py --check  # whether what ships is what is painted
"""

import argparse
import lzma
import re
from hashlib import sha256
from pathlib import Path

from eyas.engine.world.build.materials import TEXTURES
from eyas.maps.textures import shipped
from eyas.maps.textures.library import painted_textures


def main() -> None:
    """Pack the textures, or compare."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--check", action="store_true", help="write nothing")
    check = parser.parse_args().check
    painted = painted_textures()
    content = b"".join(painted[name].tobytes() for name in TEXTURES)
    digest = sha256(content).hexdigest()
    if check:
        raise SystemExit(0 if digest == shipped.SHA256 else "run `python tools/ship_textures.py`")
    shipped.FILE.write_bytes(lzma.compress(content, preset=9))
    source = Path(shipped.__file__)
    source.write_text(re.sub(r'(?m)^SHA256 = ".*"$', f'SHA256 = "{digest}"', source.read_text()))


if __name__ == "__main__":
    main()
