"""What kernels are compiled for: this processor, or graphics processors with a thread a lane.

Both are numba's processor to numba; they differ in how code holds lanes. Modules of graphics
processors get their real target only when all that a kernel calls is linked, in
`eyas.gpu.cuda.code`.
"""

from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from typing import Any

from numba.core import types
from numba.core.cpu import CPUContext
from numba.core.datamodel import default_manager
from numba.core.datamodel.manager import DataModelManager
from numba.core.registry import cpu_target

from eyas.lanes.vector.kinds import Lanes, ThreadModel


class _ThreadContext(CPUContext):  # type: ignore[misc]  # numba has no types
    """numba's knowledge of how to make code, where each lane is a thread."""

    lanes_are_threads = True

    def __init__(self) -> None:
        super().__init__(cpu_target.typing_context, "cpu")
        own = DataModelManager()
        own.register(Lanes, ThreadModel)
        self.data_model_manager = own.chain(default_manager)

    def get_function(self, fn: Any, sig: Any, _firstcall: bool = True) -> Any:  # noqa: ANN401
        """Return what makes code of a function; numba's own, such as `max`, are for numbers only,
        and are found where numba puts them.
        """
        try:
            return super().get_function(fn, sig, _firstcall)
        except NotImplementedError:
            key = fn.get_impl_key(sig) if isinstance(fn, types.Callable) else fn
            of_processor = cpu_target.target_context._defns
            if key not in of_processor or self._defns.get(key) is of_processor[key]:
                raise
            self._defns[key] = of_processor[key]
            return self.get_function(fn, sig, _firstcall)


@cache
def _thread_context() -> _ThreadContext:
    return _ThreadContext()


_threads = False


@contextmanager
def lanes_as_threads() -> Iterator[None]:
    """Compile for graphics processors meanwhile; the caller holds numba's lock of compilers."""
    global _threads  # as numba's own state, it belongs to who holds the lock
    before, _threads = _threads, True
    try:
        yield
    finally:
        _threads = before


def current_context() -> Any:  # noqa: ANN401
    """Return numba's context of what is compiled for now."""
    return _thread_context() if _threads else cpu_target.target_context


def for_threads() -> bool:
    """Return whether that is a graphics processor."""
    return _threads


def target_name() -> str:
    """Return a name of what is compiled for now, beside the processor."""
    return "threads" if _threads else "vectors"
