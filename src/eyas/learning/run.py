"""Training: a run of `eyas.learning`, which needs an extra."""

from collections.abc import Callable
from pathlib import Path

from eyas.engine.core.errors import ConfigError, MissingExtraError
from eyas.engine.settings.config import EyasConfig
from eyas.learning.config import Method, TrainConfig

__all__ = ["run"]


def run(config: EyasConfig, folder: Path, *, resume: bool, quiet: bool, ray: bool) -> Path:
    """Train a network; return the path of the ONNX file.

    Args:
        config: The settings.
        folder: Where the run is kept.
        resume: Whether to continue the run in the folder.
        quiet: Whether to print no progress.
        ray: Whether the environments run on a cluster of Ray.

    Raises:
        MissingExtraError: PyTorch, onnx or Ray is not installed.
        EyasError: A setting is wrong, or the folder.
    """
    try:
        from eyas.learning.trainer import train
    except ModuleNotFoundError as error:
        raise MissingExtraError("training", "train") from error
    say = (lambda _: None) if quiet else _say
    if TrainConfig.of(config).method in (Method.TRACKER, Method.WORDS):
        return _of_pictures(config, folder, resume=resume, say=say, ray=ray)
    if not ray:
        return train(config, folder, resume=resume, say=say)
    if TrainConfig.of(config).device is not None:
        raise ConfigError(
            f"train.device: '{TrainConfig.of(config).device}' is not there with --ray"
        )
    from eyas.learning.shards import on_ray

    with on_ray() as make_shards:
        return train(config, folder, resume=resume, say=say, make_shards=make_shards)


def _of_pictures(
    config: EyasConfig, folder: Path, *, resume: bool, say: Callable[[str], None], ray: bool
) -> Path:
    """Train a network that learns from labelled pictures, in this process."""
    from eyas.learning.tracking.training import train as train_tracker
    from eyas.learning.words.training import train as train_listener

    tracks = TrainConfig.of(config).method is Method.TRACKER
    name = "tracker" if tracks else "listener"
    if ray:
        raise ConfigError(f"--ray: not allowed for a {name}: it is taught in one process")
    if TrainConfig.of(config).device is not None:
        raise ConfigError(
            f"train.device: '{TrainConfig.of(config).device}' is not allowed for a {name}: it is taught on "
            "this processor"
        )
    train = train_tracker if tracks else train_listener
    return train(config, folder, resume=resume, say=say)


def _say(line: str) -> None:
    print(line, flush=True)
