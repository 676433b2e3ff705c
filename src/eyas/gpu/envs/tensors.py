"""Arrays on a device as users get them: of numpy on this processor, else tensors of PyTorch."""

import sys
from typing import Any

import numpy as np

Shared = Any  # An array of numpy, or a tensor of PyTorch that shares the memory of a device's array


def tensor_of(array: Any) -> Shared:  # noqa: ANN401  # a `DeviceArray`
    """Return an array on a device as users get it; its memory is shared."""
    if isinstance(array, np.ndarray):
        return array
    return torch_of(array)


def torch_of(array: Any) -> Shared:  # noqa: ANN401  # a `DeviceArray`
    """Return an array on a device as a tensor of PyTorch; its memory is shared."""
    from torch.utils.dlpack import from_dlpack

    return from_dlpack(array)


def is_tensor(actions: object) -> bool:
    """Return whether something is a tensor of PyTorch, which is imported then."""
    torch = sys.modules.get("torch")
    return torch is not None and isinstance(actions, torch.Tensor)


def as_bool(shared: Shared) -> Shared:
    """Return an array of bytes, 0 or 1, as one of truths; its memory is shared."""
    if isinstance(shared, np.ndarray):
        return shared.view(np.bool_)
    import torch

    return shared.view(torch.bool)


def copied(shared: Shared, out: Shared | None = None) -> Shared:
    """Return a copy, in `out` if that is given."""
    if out is None:
        return shared.copy() if isinstance(shared, np.ndarray) else shared.clone()
    if isinstance(out, np.ndarray):
        out[:] = shared
    else:
        out.copy_(shared)
    return out
