"""`eyas about`: what Eyas is, and under which licences it and its packages are."""

import json
import re
from collections.abc import Iterator
from typing import TYPE_CHECKING, Annotated, NamedTuple

import typer

from eyas.engine.terminal.options import AsJson

if TYPE_CHECKING:
    from importlib.metadata import Distribution

_BESIDES = {
    "shapely": "its wheel has GEOS, LGPL-2.1",
    "numpy": "its wheel has OpenBLAS, BSD-3-Clause, and libgfortran, GPL-3.0 with the exception",
    "llvmlite": "its wheel has LLVM, Apache-2.0 with the exception",
}
"""What wheels have within them, by package: their metadata do not say it."""


class Part(NamedTuple):
    """A package that a plain installation has."""

    name: str
    version: str
    licence: str  # Licence, by the package's metadata
    besides: str  # What its wheel has within it; empty: nothing that is known


def about(
    licences: Annotated[
        bool, typer.Option("--licences", help="List the packages that Eyas needs, and theirs.")
    ] = False,
    as_json: AsJson = False,
) -> None:
    """Tell what Eyas is, and under which licences it and the packages that it needs are."""
    if as_json:
        typer.echo(json.dumps([part._asdict() for part in parts()], indent=1))
        return
    from eyas.engine.core.installed import installed_version

    typer.echo(
        f"Eyas {installed_version()}: a simulator and benchmark for drone visual active tracking."
    )
    typer.echo("MIT licence, with all maps, models, textures, recordings and policies that ship.")
    if not licences:
        return
    for part in parts():
        typer.echo(f"{part.name} {part.version}: {part.licence}")
        if part.besides:
            typer.echo(f"  {part.besides}")


def parts() -> list[Part]:
    """Return the packages that Eyas needs, and those that they need, without extras."""
    from importlib.metadata import PackageNotFoundError, distribution  # slow to import

    known: dict[str, Part] = {}
    todo = ["eyas"]
    while todo:
        name = todo.pop()
        if name in known:
            continue
        try:
            found = distribution(name)
        except PackageNotFoundError:  # of another system, or removed
            continue
        known[name] = Part(name, found.version, _licence(found), _BESIDES.get(name, ""))
        todo += _needed(found)
    known.pop("eyas", None)
    return [known[name] for name in sorted(known)]


def _needed(found: "Distribution") -> Iterator[str]:
    """Yield the packages that one needs, whatever the system, without its extras."""
    for line in found.requires or ():
        name = re.match(r"[\w.-]+", line)
        if name and "extra ==" not in line:
            yield re.sub(r"[-_.]+", "-", name[0]).lower()


def _licence(found: "Distribution") -> str:
    """Return a package's licence: an expression of SPDX, or what its metadata say instead."""

    def told(key: str) -> list[str]:
        return found.metadata.get_all(key) or []

    names = [
        line.rpartition(" :: ")[2]
        for line in told("Classifier")
        if line.startswith("License ::") and not line.endswith("OSI Approved")
    ]
    said = [text.strip().partition("\n")[0] for text in told("License")]
    return next(filter(None, (*told("License-Expression"), *said, ", ".join(names))), "not told")
