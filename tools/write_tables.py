"""Fly tables of the documents, and make the figures those of the documents.

python tools/write_tables.py NAME ... --out FOLDER    # then: python tools/write_docs.py

What an interrupted run has left in the folder is not flown again.
"""

import argparse
from pathlib import Path

from eyas.benchmark.report.reproduce.run import made, write_expected
from eyas.benchmark.report.reproduce.tables import TABLES


def main() -> None:
    """Fly them."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("names", nargs="+", choices=sorted(TABLES))
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument(
        "--keep",
        action="store_true",
        help="take finished rows as they are, whatever build flew them",
    )
    asked = parser.parse_args()
    for name in asked.names:
        write_expected(name, made(TABLES[name], asked.out / name, keep=asked.keep))


if __name__ == "__main__":
    main()
