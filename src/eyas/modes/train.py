"""Training: a run of `eyas.learning`, which needs an extra."""

from pathlib import Path

from eyas.core.errors import MissingExtraError
from eyas.settings.config import EyasConfig

__all__ = ["run"]


def run(config: EyasConfig, folder: Path, *, resume: bool, quiet: bool) -> Path:
    """Train a network; return the path of the ONNX file.

    Args:
        config: The settings.
        folder: Where the run is kept.
        resume: Whether to continue the run in the folder.
        quiet: Whether to print no progress.

    Raises:
        MissingExtraError: PyTorch or onnx is not installed.
        EyasError: A setting is wrong, or the folder.
    """
    try:
        from eyas.learning.trainer import train
    except ModuleNotFoundError as error:
        raise MissingExtraError("training", "train") from error
    return train(config, folder, resume=resume, say=(lambda _: None) if quiet else _say)


def _say(line: str) -> None:
    print(line, flush=True)
