"""What the commands of this house do, as functions of Python; `eyas` offers them by these names."""

from pathlib import Path
from typing import Unpack

from eyas.engine.envs.choice import EnvChoices, Source, chosen_settings


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
