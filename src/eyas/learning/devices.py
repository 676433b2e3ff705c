"""Where PyTorch computes if environments are on a device."""

import torch

from eyas.engine.core.errors import ConfigError


def torch_device(name: str | None) -> torch.device:
    """Return where the network of a run is.

    On a graphics processor, PyTorch is told to choose convolutions that give the same each time.

    Raises:
        ConfigError: PyTorch cannot use it.
    """
    if name in (None, "host"):
        return torch.device("cpu")
    if not torch.cuda.is_available():
        build = torch.version.cuda or "none, it is PyTorch's build for processors"
        raise ConfigError(
            f"train.device: '{name}' cannot be used by PyTorch {torch.__version__} (CUDA: {build})"
        )
    torch.backends.cudnn.deterministic = True
    return torch.device(name)
