"""Operations in kernels that Python cannot express."""

import struct
from collections.abc import Callable
from functools import cached_property
from importlib import import_module
from typing import Any


class Intrinsic:
    """An operation for kernels, defined with parts of numba in a module of its own.

    numba takes half a second to import, and nothing but compiling needs it, so the module is
    imported when a kernel that names the operation is compiled.

    Args:
        module: The module.
        name: The name of the operation in it.
        python: What does the same in Python, if Python can.
    """

    def __init__(self, module: str, name: str, python: Callable[..., Any] | None = None) -> None:
        self._module, self._name, self._python = module, name, python

    @cached_property
    def _numba_type_(self) -> object:
        """The type by which numba knows it in kernels."""
        from eyas.lanes.compilation import intrinsic_type

        return intrinsic_type(getattr(import_module(self._module), self._name))

    def __call__(self, *arguments: object) -> Any:  # as the operation
        """Do it in Python.

        Raises:
            NotImplementedError: Only kernels have this operation.
        """
        if self._python is not None:
            return self._python(*arguments)
        raise NotImplementedError(f"{self._module}.{self._name} is for kernels only")


_OPERATIONS = "eyas.lanes.operations"

address_of = Intrinsic(_OPERATIONS, "address_of")
claim = Intrinsic(_OPERATIONS, "claim")
bits_of_float = Intrinsic(
    _OPERATIONS, "bits_of_float", lambda x: struct.unpack("<q", struct.pack("<d", x))[0]
)
float_of_bits = Intrinsic(
    _OPERATIONS, "float_of_bits", lambda x: struct.unpack("<d", struct.pack("<q", x))[0]
)
