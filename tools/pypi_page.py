"""Whether PyPI shows the page of a package as it is meant: as rendered, with links that lead on.

    python tools/pypi_page.py dist/eyas-1.0.0-py3-none-any.whl [page.html]

PyPI renders Markdown with `readme_renderer`, which drops what it holds to be unsafe, and resolves
no relative links. Links to this repository have to lead to a file of this checkout, and to a
heading in it; pictures have to be small enough for its proxy. Links to other sites are asked by
`sphinx-build -b linkcheck docs site/links`.
"""

import re
import sys
import zipfile
from collections.abc import Iterator
from email import message_from_bytes
from html.parser import HTMLParser
from pathlib import Path

from version import REPOSITORY

ROOT = Path(__file__).resolve().parents[1]
LARGEST_PICTURE = 5_000_000
"""Largest picture that the proxy of PyPI passes on [bytes]: `CAMO_LENGTH_LIMIT` of Camo."""
_STYLE = """<style>body { font: 16px/1.5 sans-serif; max-width: 760px; margin: 2em auto }
img { max-width: 100% } pre { overflow: auto } td { border-top: 1px solid #ddd }</style>"""
"""About as wide as the column in which PyPI shows a page."""
_FILE = re.compile(rf"{re.escape(REPOSITORY)}/(blob|raw|tree)/[^/]+/([^#]+)(?:#(.+))?")


class _Links(HTMLParser):
    """Collects the pictures and the links of a page."""

    def __init__(self) -> None:
        super().__init__()
        self.pictures: list[str] = []
        self.links: list[str] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        values = dict(attrs)
        if tag == "img":
            self.pictures.append(values.get("src") or "")
        if tag == "a" and "href" in values:
            self.links.append(values["href"] or "")


def description(wheel: Path) -> str:
    """Return the Markdown that a wheel gives PyPI."""
    with zipfile.ZipFile(wheel) as archive:
        (name,) = (each for each in archive.namelist() if each.endswith(".dist-info/METADATA"))
        return str(message_from_bytes(archive.read(name)).get_payload(decode=True), "utf-8")


def rendered(text: str) -> str:
    """Return the page that PyPI makes of Markdown.

    Raises:
        SystemExit: PyPI would show the bare text.
    """
    from readme_renderer import markdown

    page = markdown.render(text)
    if page is None:
        raise SystemExit("tools/pypi_page.py: not rendered: pip install 'readme_renderer[md]'")
    return str(page)


def faults(text: str, page: str) -> Iterator[str]:
    """Yield what is wrong with a page, a line each.

    Args:
        text: The Markdown.
        page: What PyPI makes of it, HTML.
    """
    found = _Links()
    found.feed(page)
    pictures, links = text.count("!["), text.count("](") - text.count("![")
    if len(found.pictures) != pictures:
        yield f"{pictures} pictures are written, {len(found.pictures)} shown"
    if len(found.links) < links:
        yield f"{links} links are written, {len(found.links)} shown"
    for address in (*found.pictures, *found.links):
        if not address.startswith(("https://", "#")):
            yield f"{address}: not an address"
        elif (of_ours := _FILE.fullmatch(address)) is not None:
            yield from _missing(*of_ours.groups())


def _missing(kind: str, path: str, heading: str | None) -> Iterator[str]:
    file = ROOT / path
    if not file.exists():
        yield f"{path}: no such file"
    elif kind == "raw" and file.stat().st_size > LARGEST_PICTURE:
        yield f"{path}: {file.stat().st_size:,} bytes, more than PyPI shows"
    elif heading is not None and heading not in anchors(file.read_text(encoding="utf-8")):
        yield f"{path}: no heading #{heading}"


def anchors(text: str) -> set[str]:
    """Return the anchors that GitHub gives the headings of a page of Markdown."""
    headings = re.findall(r"^#+ (.*)$", text, re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings}


def check(wheel: Path, page: Path | None = None) -> None:
    """Check the page of a wheel, and write it to a file to be looked at.

    Raises:
        SystemExit: Something is wrong with it.
    """
    text = description(wheel)
    body = rendered(text)
    if page is not None:
        page.write_text(f'<!doctype html><meta charset="utf-8">{_STYLE}{body}', encoding="utf-8")
    if found := list(faults(text, body)):
        raise SystemExit("\n".join(f"{wheel.name}: page on PyPI: {line}" for line in found))


if __name__ == "__main__":
    check(Path(sys.argv[1]), Path(sys.argv[2]) if len(sys.argv) > 2 else None)
