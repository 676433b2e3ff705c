"""What kernels need to compile for CUDA, in numba-cuda's own registries: kernels that call each
other, and pointers to bundles.
"""

from functools import cache

from numba.core import types

from eyas.core.jit import Kernel
from eyas.core.pointers import field_type, load_field

__all__ = ["prepare_cuda"]


@cache
def prepare_cuda() -> None:
    """Tell numba-cuda of kernels and of pointers; call it before compiling for CUDA.

    Raises:
        ImportError: numba-cuda is not installed; Eyas does not require it.
    """
    from numba.cuda.cudadecl import registry as typing_registry
    from numba.cuda.cudaimpl import registry as lowering_registry
    from numba.cuda.dispatcher import CUDADispatcher
    from numba.cuda.typing.templates import AttributeTemplate
    from numba.cuda.typing.typeof import typeof_impl

    @cache
    def on_device(kernel: Kernel) -> CUDADispatcher:
        options = {"device": True, "debug": False, "opt": True, "fastmath": False}
        return CUDADispatcher(kernel.py_func, options)

    @typeof_impl.register(Kernel)
    def kernel_type(kernel: Kernel, _context: object) -> types.Type:
        return on_device(kernel)._numba_type_

    @typing_registry.register_attr
    class Fields(AttributeTemplate):  # type: ignore[misc]  # numba-cuda has no types
        key = types.CPointer

        def generic_resolve(self, pointer: types.CPointer, name: str) -> types.Type | None:
            return field_type(pointer, name)

    lowering_registry.lower_getattr_generic(types.CPointer)(load_field)
