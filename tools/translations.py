"""Say which pages of `docs/zh` are older than the pages that they translate.

    python tools/translations.py             # exit code 1 if one is stale
    python tools/translations.py --done      # all have been brought up to date

A translation names its page in its first line. `docs/zh/translated.json` holds the hash of each
page as it was when it was translated, so a changed page makes its translation stale until it is
read again; tables that tools write into a page are no part of it. Code blocks are compared word by
word, whatever the hash says.
"""

import argparse
import json
import re
import sys
from hashlib import sha256
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
KNOWN = ROOT / "docs/zh/translated.json"
MADE = re.compile(r"<!-- (?:made by|table) .*?<!-- end.*?-->", re.DOTALL)
BLOCK = re.compile(r"^```(?:sh|python)\n(.*?)^```$", re.MULTILINE | re.DOTALL)


def pairs(root: Path = ROOT) -> dict[Path, Path]:
    """Return the translated pages, by translation."""
    found = {}
    for page in sorted((root / "docs/zh").glob("*.md")):
        named = re.match(r"<!-- translates: (\S+) -->", page.read_text())
        if named is None:
            raise SystemExit(f"{page}: does not name the page that it translates in its first line")
        found[page] = root / named[1]
    return found


def hash_of(page: Path) -> str:
    """Return the hash of a page, without the tables that tools write into it."""
    return sha256(MADE.sub("", page.read_text()).encode()).hexdigest()[:16]


def stale(root: Path = ROOT) -> list[str]:
    """Return a line for each translation that its page has left behind."""
    known = json.loads((root / KNOWN.relative_to(ROOT)).read_text())
    lines = []
    for page, of in pairs(root).items():
        name, source = page.relative_to(root), of.relative_to(root)
        if known.get(str(source)) != hash_of(of):
            lines.append(f"{name}: stale: {source} has changed since it was translated")
        if _code(page) != _code(of, within=_code(page)):
            lines.append(f"{name}: has other commands than {source}")
    return lines


def _code(page: Path, within: list[str] | None = None) -> list[str]:
    """Return the blocks of code of a page, without comments and strings; of those, only such."""
    bare = [re.sub(r'#.*|"[^"]*"', "", text) for text in BLOCK.findall(page.read_text())]
    return bare if within is None else [text for text in bare if text in within]


def main() -> int:
    """Say what is stale, or that nothing is any more."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--done", action="store_true", help="all translations are up to date")
    if parser.parse_args().done:
        hashes = {str(of.relative_to(ROOT)): hash_of(of) for of in pairs().values()}
        KNOWN.write_text(json.dumps(hashes, indent=1) + "\n")
    lines = stale()
    print(*lines, sep="\n", end="\n" if lines else "")
    return int(bool(lines))


if __name__ == "__main__":
    sys.exit(main())
