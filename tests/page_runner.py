"""Runs the blocks of code of a page from top to bottom, as a reader would: `page_runner.py PAGE`.

Blocks of `sh` are run by bash, together with what they export; those of `python` are parts of one
session. What stands before a block says what else is to be done with it:

    <!-- not run: why -->     it is passed over
    <!-- file: NAME -->       it is saved as this file
"""

import os
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

BLOCK = re.compile(r"(?:^<!-- ([^>]*) -->\n)?^```(\w+)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
AFTER = '\nset +x; env -0 > "$RUNNER_ENV"'


class Block(NamedTuple):
    """A block of code of a page."""

    mark: str
    language: str
    text: str
    line: int


def blocks(page: Path) -> Iterator[Block]:
    """Yield the blocks of a page that a reader runs or saves."""
    text = page.read_text()
    for found in BLOCK.finditer(text):
        mark, language, code = found.groups()
        if language in ("sh", "bash", "python") or (mark or "").startswith("file:"):
            yield Block(mark or "", language, code, text[: found.start()].count("\n") + 1)


def main() -> None:
    """Run the blocks of a page in the current folder."""
    page = Path(sys.argv[1])
    sys.path.insert(0, os.getcwd())
    session: dict[str, object] = {"__name__": "__main__"}
    for block in blocks(page):
        if block.mark.startswith(("not run:", "test command")):
            continue
        print(f"+ {page.name}:{block.line}", flush=True)
        if block.mark.startswith("file:"):
            Path(block.mark.removeprefix("file:").strip()).write_text(block.text)
        elif block.language == "python":
            exec(compile(block.text, f"{page.name}:{block.line}", "exec"), session)
        else:
            _shell(block.text)


def _shell(text: str) -> None:
    """Run lines of a shell; what they export stays for the next block."""
    known = Path("runner-environment")
    told = {**os.environ, "RUNNER_ENV": str(known)}
    subprocess.run(["bash", "-euo", "pipefail", "-xc", text + AFTER], env=told, check=True)
    pairs = (pair.split("=", 1) for pair in known.read_text().split("\0") if pair)
    os.environ.update({name: value for name, value in pairs if not name.startswith("BASH_FUNC")})
    known.unlink()


if __name__ == "__main__":
    main()
