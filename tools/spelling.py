"""Check the spelling of documents, docstrings, comments and messages: `python tools/spelling.py`.

Two tools look: codespell finds mistakes that are known to be made, in all files of text, also
within names; the dictionary of pyspellchecker says which words of the prose it does not know.
Words of the field, which it cannot know, stand in `tools/words.txt`, one a line, sorted; what is
a name of code stands in backticks, and is not read.

    python tools/spelling.py                 # print mistakes; 1 if there are any
    python tools/spelling.py --regenerate    # write the list anew: look at its difference
"""

import argparse
import ast
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import TypeGuard

from spellchecker import SpellChecker

ROOT = Path(__file__).parents[1]
OWN = ROOT / "tools/words.txt"
PAGES = ("*.md", "docs/**/*.md", ".ci/*")
CODE = ("src", "art", "tests", "examples", "tools", "bench")
NO_PROSE = re.compile(
    r"""^\ *```.*?^\ *```      # blocks of code
    | ``.*?`` | `[^`]*`        # code in a line
    | https?://\S+ | \]\([^)]*\)           # where links lead
    | <[^>]+> | \{[^}]*\} | &\w+;          # HTML, what a message fills in
    | \S*[/\\@=_\#]\S*         # paths, settings, names of code
    | \b\w+\.\w+(?:\.\w+)*     # the same
    | --[a-z][\w-]*            # options
    """,
    re.MULTILINE | re.DOTALL | re.VERBOSE,
)
STRING_OR_COMMENT = re.compile(  # twenty times as fast as `tokenize`
    r"""(\"{3}|'{3})(?:\\.|.)*?\1 | "(?:\\.|[^"\\\n])*" | '(?:\\.|[^'\\\n])*' | \#[^\n]*""",
    re.DOTALL | re.VERBOSE,
)
WORD = re.compile(r"[^\W\d_]{3,}(?:'[^\W\d_]+)?")
MADE = r"<!--\ made\ by.*?<!--\ end\ -->"  # the schema, tables
UNWANTED = re.compile(
    r"\b(?:told(?!\sapart)|tells(?!\s(?:\w+\s)?apart)|nobody|no\sone|besides|that\swhich|(?<!there\s)(?:is|are)\snone"
    r"|who(?:ever)?\swants)\b",
    re.I,
)
"""What reads as translated: a document shows, reports or names; people are "they"."""


def main() -> int:
    """Print what is misspelt; return 1 if anything is."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--regenerate", action="store_true", help="write tools/words.txt anew")
    unknown = unknown_words(ROOT)
    if parser.parse_args().regenerate:
        OWN.write_text("".join(f"{word}\n" for word in sorted(unknown)))
    own = set(OWN.read_text().split())
    for word in sorted(unknown.keys() - own):
        print(f"{unknown[word]}: not in the dictionary: {word}")
    for word in sorted(own - unknown.keys()):
        print(f"{OWN.relative_to(ROOT)}: nothing needs it: {word}")
    awkward = list(unwanted(ROOT))
    print(*awkward, sep="\n", end="\n" if awkward else "")
    known_mistakes = subprocess.run([sys.executable, "-m", "codespell_lib"], cwd=ROOT).returncode
    return int(bool(unknown.keys() ^ own or awkward or known_mistakes))


def unwanted(root: Path) -> Iterator[str]:
    """Yield a line for each word of README, CONTRIBUTING and `docs` that another says better.

    Parts that are made from the code, cards of policies and dated notes are left out.
    """
    for place, text in _pages(root):
        if re.match(r"README|CONTRIBUTING|docs/(?!lab/|policies/)", place):
            plain = re.sub(f"{MADE}|{NO_PROSE.pattern}", _lines_of, text, flags=NO_PROSE.flags)
            for found in UNWANTED.finditer(plain):
                at = 1 + plain.count("\n", 0, found.start())
                yield f"{place}:{at}: write it otherwise: {' '.join(found[0].split())}"


def unknown_words(root: Path) -> dict[str, str]:
    """Return words of a tree's prose that the dictionary lacks, each with a place: FILE:LINE."""
    dictionary = set(SpellChecker(language="en").word_frequency.dictionary)
    places: dict[str, str] = {}
    for place, line, text in _texts(root):
        plain = NO_PROSE.sub(_lines_of, text)
        for number, part in enumerate(plain.split("\n"), line):
            for word in WORD.findall(part):
                places.setdefault(word, f"{place}:{number}")
    unknown: dict[str, str] = {}
    for word, place in places.items():
        lower = word.lower()
        if _is_word(word) and not {lower, re.sub(r"'s?$", "", lower)} & dictionary:
            unknown.setdefault(re.sub(r"'s?$", "", lower), place)
    return unknown


def _lines_of(found: re.Match[str]) -> str:
    """Return as many empty lines as a match has."""
    return " " + "\n" * found[0].count("\n")


def _is_word(word: str) -> bool:
    """Return whether letters are a word, and no abbreviation or name of code such as `PyAV`."""
    return word.isascii() and word[1:].islower()


def _pages(root: Path) -> Iterator[tuple[str, str]]:
    """Yield each document: its file, its text."""
    for page in sorted({page for pattern in PAGES for page in root.glob(pattern)}):
        if "zh" not in page.relative_to(root).parts:
            yield page.relative_to(root).as_posix(), page.read_text()


def _texts(root: Path) -> Iterator[tuple[str, int, str]]:
    """Yield each text of prose: its file, its first line, itself."""
    for place, text in _pages(root):
        yield place, 1, text
    for folder in CODE:
        for file in sorted((root / folder).rglob("*.py")):
            place, source = file.relative_to(root).as_posix(), file.read_text()
            for found in STRING_OR_COMMENT.finditer(source):
                if found[0].startswith("#"):
                    yield place, source.count("\n", 0, found.start()) + 1, found[0]
            if folder != "tests":  # their texts are mistakes on purpose, and parts of files
                for node in ast.walk(ast.parse(source)):
                    if isinstance(node, ast.Constant) and _is_prose(node.value):
                        yield place, node.lineno, node.value


def _is_prose(value: object) -> TypeGuard[str]:
    """Return whether a constant is a docstring or a message, and no name or value."""
    return isinstance(value, str) and value.count(" ") >= 2


if __name__ == "__main__":
    sys.exit(main())
