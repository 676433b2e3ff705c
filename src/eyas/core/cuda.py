"""What kernels need to compile for CUDA: pointers to bundles, in numba-cuda's own registries."""

from numba.core import types
from numba.cuda.cudadecl import registry as typing_registry
from numba.cuda.cudaimpl import registry as lowering_registry
from numba.cuda.typing.templates import AttributeTemplate

from eyas.core.pointers import field_type, load_field

__all__: list[str] = []


@typing_registry.register_attr
class _Fields(AttributeTemplate):  # type: ignore[misc]  # numba-cuda has no types
    key = types.CPointer

    def generic_resolve(self, pointer: types.CPointer, name: str) -> types.Type | None:
        return field_type(pointer, name)


lowering_registry.lower_getattr_generic(types.CPointer)(load_field)
