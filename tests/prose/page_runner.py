"""Runs the blocks of code of a page from top to bottom, as a reader would: `page_runner.py PAGE`.

Blocks of `sh` are run by bash, together with what they export; those of `python` are parts of one
session. What stands before a block says what else is to be done with it:

    <!-- not run: why -->            it is passed over
    <!-- interrupted: why -->        each `eyas` in it gets Ctrl-C after 20 s, unless it ends before
    <!-- file: NAME -->              it is saved as this file

What a page takes for granted stands in a comment of its own, and is run too:

    <!-- before sh                   or `before python`
    mkdir DAT
    -->

Without a page it lists all blocks that are passed over or interrupted.
"""

import os
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).parents[2]
BLOCK = re.compile(
    r"(?:^<!-- (?!before)([^>]*) -->\n)?^```(\w+)\n(.*?)^```$"
    r"|^<!-- before (sh|python)\n(.*?)^-->$",
    re.MULTILINE | re.DOTALL,
)
RUN = ("sh", "bash", "python")
LATER = ("not run: ", "test command")
INTERRUPTED = 'eyas() { timeout --preserve-status -k 60 -s INT 20 eyas "$@" || [ $? -eq 130 ]; }\n'
AFTER = '\nset +x; env -0 > "$RUNNER_ENV"'


class Block(NamedTuple):
    """A block of code of a page."""

    mark: str
    language: str
    text: str
    line: int
    hidden: bool


def pages() -> list[Path]:
    """Return the pages that have code to run."""
    return [page for page in _pages() if any(_is_run(each) for each in blocks(page))]


def _pages() -> list[Path]:
    return [*sorted(ROOT.glob("*.md")), *sorted(ROOT.glob("docs/**/*.md"))]


def blocks(page: Path) -> Iterator[Block]:
    """Yield the blocks of a page that a reader runs or saves."""
    text = page.read_text()
    for found in BLOCK.finditer(text):
        mark, language, code, hidden, first = found.groups()
        line = text[: found.start()].count("\n") + 1
        if hidden:
            yield Block("", hidden, first, line, True)
        elif language in (*RUN, "console") or (mark or "").startswith("file:"):
            yield Block(mark or "", language, code, line, False)


def _is_run(block: Block) -> bool:
    return not block.mark.startswith(LATER)


def main() -> None:
    """Run the blocks of a page in the current folder, or list those of all that are not run."""
    if len(sys.argv) == 1:
        for page in _pages():
            for block in blocks(page):
                if block.mark.startswith(("not run: ", "interrupted: ")):
                    print(f"{page.relative_to(ROOT)}:{block.line}: {block.mark}")
        return
    page = Path(sys.argv[1])
    sys.path.insert(0, os.getcwd())
    session: dict[str, object] = {"__name__": "__main__"}
    for block in filter(_is_run, blocks(page)):
        print(f"+ {page.name}:{block.line}", flush=True)
        if block.mark.startswith("file:"):
            Path(block.mark.removeprefix("file:").strip()).write_text(block.text)
        elif block.language == "python":
            exec(compile(block.text, f"{page.name}:{block.line}", "exec"), session)
        else:
            _shell(INTERRUPTED * block.mark.startswith("interrupted: ") + block.text)


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
