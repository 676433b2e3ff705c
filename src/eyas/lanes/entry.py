"""The address of a kernel that gets bundles: from its file, or compiled, which takes seconds."""

import logging
import platform
import threading
import time
from collections.abc import Callable
from importlib.metadata import version
from pathlib import Path
from typing import Any

from eyas.lanes.bundles import PackedBundle
from eyas.lanes.folder import kernel_folder, refusal
from eyas.lanes.identity import identity
from eyas.lanes.interrupts import shielded
from eyas.lanes.machine_code import (
    SUFFIX,
    MachineCode,
    code_file,
    code_name,
    entry_of,
    load,
    read_code,
    write_code,
)
from eyas.lanes.shipped import is_shipped, shipped_code
from eyas.lanes.trusted import OWNER, touch

_LOG = logging.getLogger(OWNER)

LOCK = threading.RLock()  # PackedBundle while numba and LLVM compile


def entry_address(
    function: Callable[..., Any],  # See `eyas.lanes.calls.CompiledCall`
    bundles: tuple[PackedBundle[Any], ...],  # What it is called with
    *,
    over_workers: bool,
) -> int:
    """Return the address of a kernel for bundles of these kinds."""
    name = function.__qualname__.rpartition(".")[2]
    made_by = version("numba"), platform.python_version()
    kinds = [bundle.kind for bundle in bundles]
    path = code_file(kernel_folder(), _name_of(function), kinds, made_by)
    keeps = function.__closure__ is None  # or what it depends on is not all in the name
    # An interrupt in the middle of numba or LLVM leaves objects in pieces, whose end crashes.
    with LOCK, shielded():
        address = _kept(path) if keeps else None
        if address is None:
            start = time.perf_counter()
            code = _compiled(function, bundles, entry_of(path), over_workers=over_workers)
            _LOG.debug("compiled %s in %.1f s", name, time.perf_counter() - start)
            address = load(code)
            assert address is not None, f"{name}: cannot be loaded; it needs {code.needs}"
            if keeps and not refusal():
                write_code(path, code)
    return address


def _kept(path: Path) -> int | None:
    """Return the address of a kernel that ships, or else is cached; None if it is neither.

    What ships comes first: compiled for the very processor, with AVX-512, a step took 10 % longer.
    """
    shipped = shipped_code(path.stem.rpartition("-")[0])
    address = None if shipped is None else load(shipped)
    if address is None and (kept := read_code(path)) is not None:
        touch(path)
        address = load(kept)
    return address


def nothing_compiled(
    function: Callable[..., Any],  # See `eyas.lanes.calls.CompiledCall`
) -> bool:
    """Return whether a kernel is neither cached nor shipped for any bundles, as at first."""
    name = _name_of(function)
    return not any(kernel_folder().glob(f"{name}-*{SUFFIX}")) and not is_shipped(name)


def _name_of(function: Callable[..., Any]) -> str:
    return code_name(function.__qualname__.rpartition(".")[2], identity(function))


def _compiled(
    function: Callable[..., Any],
    bundles: tuple[PackedBundle[Any], ...],
    entry: str,
    *,
    over_workers: bool,
) -> MachineCode:
    import numba  # half a second, for the first start only

    from eyas.lanes.compilation import entry_code, size_of

    for held in bundles:
        kind = numba.typeof(held.bundle)
        assert size_of(kind) == held.size, f"this version of numba lays {kind} out differently"
    kinds = [numba.typeof(held.bundle) for held in bundles]
    return entry_code(function, kinds, entry, over_workers=over_workers)
