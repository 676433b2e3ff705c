"""Training, from Python and from the command line; all else of the house needs an extra."""

from pathlib import Path
from typing import Unpack

from eyas.engine.core.errors import ConfigError, MissingExtraError
from eyas.engine.core.own_code import running
from eyas.engine.envs.choice import EnvChoices, Source, chosen_settings
from eyas.engine.settings.config import EyasConfig
from eyas.learning.config import ALGORITHMS, SETTING, TrainConfig


def run(config: EyasConfig, folder: Path, *, resume: bool, quiet: bool, ray: bool) -> Path:
    """Train a network; return the path of the ONNX file.

    Raises:
        MissingExtraError: PyTorch, onnx or Ray is not installed.
        EyasError: A setting is wrong, or the folder.
    """
    try:
        from eyas.learning.trainer import train
    except ModuleNotFoundError as error:
        raise MissingExtraError("training", "train") from error
    say = (lambda _: None) if quiet else _say
    method = TrainConfig.of(config).method
    whole = None if "+" in method else ALGORITHMS.get(method)
    with running(SETTING, method):
        if whole is not None and not isinstance(whole, type):
            _refuse_spread(config, ray=ray)
            path: Path = whole(config, folder, resume=resume, say=say)
            return path
        if not ray:
            return train(config, folder, resume=resume, say=say)
        if TrainConfig.of(config).device is not None:
            raise ConfigError(
                f"train.device: '{TrainConfig.of(config).device}' is not there with --ray"
            )
        from eyas.learning.shards import on_ray

        with on_ray() as make_shards:
            return train(config, folder, resume=resume, say=say, make_shards=make_shards)


def _refuse_spread(config: EyasConfig, *, ray: bool) -> None:
    """Refuse to spread what learns without rollouts: one process on this processor does."""
    method, device = TrainConfig.of(config).method, TrainConfig.of(config).device
    if ray:
        raise ConfigError(f"--ray: not allowed with {SETTING} '{method}': one process learns")
    if device is not None:
        raise ConfigError(
            f"train.device: '{device}' is not allowed with {SETTING} '{method}': it learns on "
            "this processor"
        )


def _say(line: str) -> None:
    print(line, flush=True)


def train(
    config: Source = None,
    out: Path | str = "runs/train",
    *,
    resume: bool = False,
    quiet: bool = True,
    **choices: Unpack[EnvChoices],
) -> Path:
    """Train a policy, like `eyas train` (extra `train`); return the path of its ONNX file.

    Args:
        config: The settings, see `make_config`.
        out: The folder of the run.
        resume: Whether a run in the folder is continued.
        quiet: Whether no progress is printed.
        choices: Settings by keyword.

    Raises:
        EyasError: A setting is wrong, or the folder; one line.
    """
    from eyas.learning.run import run

    return run(chosen_settings(config, **choices), Path(out), resume=resume, quiet=quiet, ray=False)
