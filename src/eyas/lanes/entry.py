"""The address of a kernel that gets bundles: from what ships, from its file, or compiled, which
takes seconds.
"""

import logging
import platform
import threading
import time
from collections.abc import Callable
from importlib.metadata import version
from importlib.util import find_spec
from typing import TYPE_CHECKING, Any

from eyas.lanes.bundles import PackedBundle
from eyas.lanes.folder import kernel_folder, refusal
from eyas.lanes.identity import code_name, entry_of
from eyas.lanes.interrupts import shielded
from eyas.lanes.jit import CompilerError
from eyas.lanes.shipped import misfit, shipped_address
from eyas.lanes.trusted import OWNER, not_kept, touch

if TYPE_CHECKING:
    from eyas.lanes.machine_code import MachineCode

_LOG = logging.getLogger(OWNER)

LOCK = threading.RLock()  # Held while numba and LLVM compile

EXTRA = "compile"  # The extra that brings numba and LLVM


def entry_address(
    function: Callable[..., Any],  # See `eyas.lanes.calls.CompiledCall`
    bundles: tuple[PackedBundle[Any], ...],  # What it is called with
    *,
    over_workers: bool,
) -> int:
    """Return the address of a kernel for bundles of these kinds.

    What ships comes first: compiled for the very processor, with AVX-512, a step took 10 % longer.

    Raises:
        CompilerError: It has to be compiled, and the compiler is not installed.
    """
    name = code_name(function, [bundle.kind for bundle in bundles])
    keeps = function.__closure__ is None  # or what it depends on is not all in the name
    shipped = shipped_address(name) if keeps else None
    if shipped is not None:
        return shipped
    require_compiler(name.partition("-")[0])
    # An interrupt in the middle of numba or LLVM leaves objects in pieces, whose end crashes.
    with LOCK, shielded():
        return _made(name, function, bundles, keeps=keeps, over_workers=over_workers)


def require_compiler(
    name: str,  # Of a function
) -> None:
    """Refuse to compile where numba is not installed.

    Raises:
        CompilerError: It is not.
    """
    if find_spec("numba") is None:
        why = f"what ships is {misfit()}" if misfit() else "it ships with other settings only"
        raise CompilerError(
            f"{name}: no machine code ({why}); to compile it: pip install '{OWNER}[{EXTRA}]'"
        )


def _made(
    name: str,
    function: Callable[..., Any],
    bundles: tuple[PackedBundle[Any], ...],
    *,
    keeps: bool,
    over_workers: bool,
) -> int:
    """Return the address of a kernel from its file, or compile it."""
    from eyas.lanes.machine_code import code_file, load, read_code, write_code  # LLVM

    path = code_file(kernel_folder(), name, (version("numba"), platform.python_version()))
    if keeps and (kept := read_code(path)) is not None:
        touch(path)
        address = load(kept)
        if address is not None:
            return address
    if misfit() and not refusal() and not any(path.parent.glob(f"*{path.suffix}")):
        _LOG.warning("first start here: compiling takes a minute, once; kept in %s", path.parent)
    start = time.perf_counter()
    code = _compiled(function, bundles, entry_of(name), over_workers=over_workers)
    _LOG.debug("compiled %s in %.1f s", name.partition("-")[0], time.perf_counter() - start)
    address = load(code)
    assert address is not None, f"{name}: cannot be loaded; it needs {code.needs}"
    if keeps and (why := refusal()):
        not_kept(why)
    elif keeps:
        write_code(path, code)
    return address


def _compiled(
    function: Callable[..., Any],
    bundles: tuple[PackedBundle[Any], ...],
    entry: str,
    *,
    over_workers: bool,
) -> "MachineCode":
    import numba  # half a second, for the first start only

    from eyas.lanes.compilation import entry_code, size_of

    for held in bundles:
        kind = numba.typeof(held.bundle)
        assert size_of(kind) == held.size, f"this version of numba lays {kind} out differently"
    kinds = [numba.typeof(held.bundle) for held in bundles]
    return entry_code(function, kinds, entry, over_workers=over_workers)
