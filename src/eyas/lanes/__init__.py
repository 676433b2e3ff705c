"""Python that becomes SIMD and PTX: kernels for lanes of the processor, compiled and kept on disk.

May import: nothing of Eyas.
Begin with `README.md` and `docs/lanes.md`, then `jit.py`; operations on lanes are in
`eyas.lanes.vector`, elementary functions in `eyas.lanes.elementary`.
"""

from eyas.lanes.bundles import PackedBundle
from eyas.lanes.calls import BoundCall, CompiledCall, ParallelCall, compiled, parallel
from eyas.lanes.intrinsics import Intrinsic, address_of, bits_of_float, claim, float_of_bits
from eyas.lanes.jit import (
    CompilerError,
    Kernel,
    LanesError,
    VariableError,
    interpreted,
    kernel,
    limit_threads,
    specialised,
    thread_count,
)

__all__ = [
    "BoundCall",
    "CompiledCall",
    "CompilerError",
    "Intrinsic",
    "Kernel",
    "LanesError",
    "PackedBundle",
    "ParallelCall",
    "VariableError",
    "address_of",
    "bits_of_float",
    "claim",
    "compiled",
    "float_of_bits",
    "interpreted",
    "kernel",
    "limit_threads",
    "parallel",
    "specialised",
    "thread_count",
]
