"""Operations in kernels that Python cannot express."""

from functools import cached_property
from importlib import import_module
from typing import Any

__all__ = ["Intrinsic", "address_of", "claim"]


class Intrinsic:
    """An operation for kernels, defined with parts of numba in a module of its own.

    numba takes half a second to import, and nothing but compiling needs it, so the module is
    imported when a kernel that names the operation is compiled.

    Args:
        module: The module.
        name: The name of the operation in it.
    """

    def __init__(self, module: str, name: str) -> None:
        self._module, self._name = module, name

    @cached_property
    def _numba_type_(self) -> object:
        """The type by which numba knows it in kernels."""
        from eyas.core.compilation import intrinsic_type

        return intrinsic_type(getattr(import_module(self._module), self._name))

    def __call__(self, *arguments: object) -> Any:  # as the operation
        """Refuse to run: only kernels have this operation."""
        raise NotImplementedError(f"{self._module}.{self._name} is for kernels only")


address_of = Intrinsic("eyas.core.pointers", "address_of")
claim = Intrinsic("eyas.core.atomics", "claim")
