"""Draw the picture of all targets for the documents: `python tools/targets_page.py FILE`."""

import subprocess
import sys
import tempfile
from pathlib import Path

from PIL import Image


def main() -> None:
    """Have `eyas targets show` draw it, and write it as JPEG, a quarter of the size."""
    with tempfile.TemporaryDirectory() as folder:
        drawn = Path(folder) / "all.png"
        run = [sys.executable, "-m", "eyas", "targets", "show", "all", "--out", str(drawn)]
        subprocess.run(run, check=True, stdout=subprocess.DEVNULL)
        picture = Image.open(drawn).convert("RGB")
    picture.save(sys.argv[1], quality=85, optimize=True)


if __name__ == "__main__":
    main()
