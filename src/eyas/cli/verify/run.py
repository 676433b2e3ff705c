"""Compute the cases of the manifest, and say what differs."""

import ctypes
import json
import os
import platform
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from importlib.metadata import PackageNotFoundError, version
from importlib.resources import files
from itertools import groupby
from pathlib import Path
from typing import NamedTuple

from eyas.cli.verify.cases import Case, cases
from eyas.engine.core.errors import DataFileError, UnknownNameError
from eyas.engine.core.installed import installed_version
from eyas.engine.core.machine import describe_machine
from eyas.engine.core.scratch import scratch
from eyas.engine.terminal.ending import print_ending
from eyas.engine.terminal.progress import frames_bar
from eyas.lanes import thread_count
from eyas.lanes.trusted import FOLDER_VARIABLE

Hashes = dict[str, dict[str, str]]  # Hashes by case, then by what is hashed


def manifest_path() -> Path:
    """Return the file that comes with the package."""
    return Path(str(files("eyas.cli.verify"))) / "manifest.json"


def read_manifest() -> Hashes:
    """Return the hashes of the manifest.

    Raises:
        DataFileError: The installation is damaged.
    """
    try:
        told: Hashes = json.loads(manifest_path().read_text())["hashes"]
    except (OSError, ValueError, KeyError) as error:
        raise DataFileError(f"{manifest_path()}: missing or damaged; install Eyas again") from error
    return told


def text_of(hashes: Hashes) -> str:
    """Return the content of the file."""
    return json.dumps({"eyas": installed_version(), "hashes": hashes}, indent=1) + "\n"


_PACKAGES = ("numpy", "numba", "llvmlite", "shapely", "pillow", "pydantic", "gymnasium")

_CHOICES = (
    "OPENBLAS_CORETYPE",
    "NPY_DISABLE_CPU_FEATURES",
    "NUMBA_CPU_NAME",
    "GLIBC_TUNABLES",
    "NUMBA_NUM_THREADS",
)
"""Variables by which a machine can be made to look like another."""


def machine_facts() -> dict[str, str]:
    """Return what a machine computes with, by names for people."""
    packages = [f"{name} {_version(name)}" for name in _PACKAGES]
    facts = {
        "machine": describe_machine(),
        "Eyas": f"{installed_version()}, {thread_count()} threads",
        "packages": ", ".join(packages),
        "libraries": f"{' '.join(platform.libc_ver())}, BLAS for {_blas_kernel()}",
    }
    chosen = [f"{name}={os.environ[name]}" for name in _CHOICES if name in os.environ]
    return facts | ({"set": ", ".join(chosen)} if chosen else {})


def _version(package: str) -> str:
    try:
        return version(package)
    except PackageNotFoundError:
        return "(unknown)"


def _blas_kernel() -> str:
    """Return the kind of processor whose functions OpenBLAS has chosen."""
    maps = Path("/proc/self/maps")
    lines = maps.read_text().splitlines() if maps.exists() else []
    for path in sorted({line.split()[-1] for line in lines if "openblas" in line}):
        library = ctypes.CDLL(path)
        for prefix, suffix in (("scipy_", "64_"), ("", "64_"), ("scipy_", ""), ("", "")):
            tell = getattr(library, f"{prefix}openblas_get_corename{suffix}", None)
            if tell is not None:
                tell.restype = ctypes.c_char_p
                return str(tell().decode())
    return "an unknown processor"


class Verdict(NamedTuple):
    """What was compared."""

    same: int  # Number of hashes that are those of the manifest
    different: dict[str, list[str]]  # Names of the others by case


def run(*, quick: bool = False, map_name: str | None = None, as_json: bool = False) -> bool:
    """Compute, print what differs, and return whether all is as promised.

    Args:
        map_name: Look at the cases of this map only; None: at all.

    Raises:
        UnknownNameError: The manifest has no such map.
        DataFileError: The installation is damaged.
    """
    known = read_manifest()
    chosen = _chosen(quick, map_name)
    found = measured(chosen)
    verdict = compared(found, known)
    facts = machine_facts()
    if as_json:
        told = {"same": verdict.same, "different": verdict.different, "machine": facts}
        print(json.dumps(told | {"hashes": found}, indent=2))
    else:
        _print(verdict, facts, len(chosen))
    return not verdict.different


def measured(chosen: Iterable[Case]) -> Hashes:
    """Return the hashes of cases, and show meanwhile on a screen how many are computed.

    Nothing is taken from the cache, which another machine may have filled, but compiled kernels.
    """
    found: Hashes = {}
    listed = list(chosen)
    with frames_bar("verifying", len(listed), quiet=False) as told:
        for _, of_map in groupby(listed, key=lambda case: case.map):
            with _empty_cache():
                for case in of_map:
                    found[case.name] = case.measure()
                    told(len(found))
    return found


@contextmanager
def _empty_cache() -> Iterator[None]:
    """Have what is kept written to a folder that is removed at the end."""
    before = os.environ.get(FOLDER_VARIABLE)
    with scratch() as folder:
        os.environ[FOLDER_VARIABLE] = str(folder)
        try:
            yield
        finally:
            if before is None:
                del os.environ[FOLDER_VARIABLE]
            else:
                os.environ[FOLDER_VARIABLE] = before


def compared(found: Hashes, known: Hashes) -> Verdict:
    """Return what is the same and what is not."""
    same, different = 0, {}
    for case, hashes in found.items():
        promised = known.get(case, {})
        names = [name for name in hashes if promised.get(name) != hashes[name]]
        names += [name for name in promised if name not in hashes]
        same += sum(name not in names for name in hashes)
        if names:
            different[case] = names
    return Verdict(same, different)


def _chosen(quick: bool, map_name: str | None) -> list[Case]:
    every = list(cases())
    names = tuple(dict.fromkeys(case.map for case in every))
    if map_name is not None and map_name not in names:
        raise UnknownNameError("--map", map_name, names)
    of_map = [case for case in every if map_name in (None, case.map)]
    few = [case for case in of_map if case.quick]
    return few if quick and few else of_map


def _print(verdict: Verdict, facts: dict[str, str], count: int) -> None:
    for case, names in verdict.different.items():
        print(f"differs: {case}: {', '.join(names)}")
    other = sum(map(len, verdict.different.values()))
    for name, fact in facts.items():
        print(f"{name}: {fact}")
    if other:
        print_ending(
            f"{other} of {verdict.same + other} hashes, in {len(verdict.different)} of {count} "
            "cases, are not those of the manifest",
            ("report it, with all of this", ("eyas", "verify", "--json")),
        )
        return
    print_ending(
        f"all {verdict.same} hashes, in {count} cases, are those of the manifest",
        ("fly a row of the documents' tables again", ("eyas", "reproduce")),
    )
