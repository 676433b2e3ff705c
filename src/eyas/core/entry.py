"""The address of a kernel that gets bundles: from its file, or compiled, which takes seconds."""

import platform
import threading
from collections.abc import Callable
from importlib.metadata import version
from typing import Any

from eyas.core.held import Held
from eyas.core.interrupts import shielded
from eyas.core.jit import REFUSAL, folder_in_use, identity
from eyas.core.machine_code import MachineCode, code_file, load, read_code, write_code

__all__ = ["entry_address"]

_LOCK = threading.RLock()


def entry_address(function: Callable[..., Any], parts: tuple[Held[Any], ...]) -> int:
    """Return the address of a kernel for bundles of these kinds.

    Args:
        function: See `eyas.core.parallel.parallel_kernel`.
        parts: The bundles.
    """
    name = function.__qualname__.rpartition(".")[2]
    versions = (version("numba"), platform.python_version())
    key = (*versions, identity(function), *(part.kind for part in parts))
    path = code_file(folder_in_use(), name, key)
    kept = function.__closure__ is None  # or what it depends on is not all in the key
    # An interrupt in the middle of numba or LLVM leaves objects in pieces, whose end crashes.
    with _LOCK, shielded():
        found = read_code(path) if kept else None
        address = None if found is None else load(found)
        if address is None:
            code = _compiled(function, parts, path.stem.replace("-", "_"))
            address = load(code)
            assert address is not None, f"{name}: calls functions that do not exist: {code.needs}"
            if kept and not REFUSAL:
                write_code(path, code)
    return address


def _compiled(
    function: Callable[..., Any], parts: tuple[Held[Any], ...], entry: str
) -> MachineCode:
    import numba  # half a second, for the first start only

    from eyas.core.compilation import entry_code, size_of

    kinds = [numba.typeof(part.bundle) for part in parts]
    for kind, part in zip(kinds, parts, strict=True):
        assert size_of(kind) == part.size, f"this version of numba lays {kind} out differently"
    pointers = [numba.types.CPointer(kind) for kind in kinds]
    table = numba.types.CPointer(numba.types.Tuple(pointers))
    return entry_code(function, (table, numba.types.intp, numba.types.intp), entry)
