"""Where the curves of a training go beside `curve.csv`: TensorBoard, Weights & Biases, MLflow, or
an object of one's own.
"""

import math
from collections.abc import Callable, Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any, Protocol

from eyas.engine.core.errors import EyasError, one_line
from eyas.engine.core.registry import Registry


class Logger(Protocol):
    """Gets the numbers of a training after each block. It is made of the run's folder and of its
    settings, nested dictionaries; it must not change either.
    """

    def add(self, decisions: int, values: Mapping[str, float]) -> None:
        """Add a point to each curve.

        Args:
            decisions: Decisions of all environments so far.
            values: Numbers by the names of the columns of `curve.csv`; those that are not known
                are left out.
        """
        ...

    def end(self) -> None:
        """End the run."""
        ...


class TensorBoard:
    """Writes numbers for TensorBoard into the folder `tensorboard`, if it is installed."""

    def __init__(self, folder: Path, settings: Mapping[str, Any]) -> None:
        self._writer: Any = None
        self._folder = folder / "tensorboard"
        with suppress(ImportError):  # curve.csv has the same
            from torch.utils.tensorboard import SummaryWriter

            self._writer = SummaryWriter

    def add(self, decisions: int, values: Mapping[str, float]) -> None:
        """Add a point to each curve; after an interrupted run, in the place of later ones."""
        if self._writer is None:
            return
        with self._writer(str(self._folder), purge_step=decisions) as writer:
            for name, value in values.items():
                writer.add_scalar(name, value, decisions)

    def end(self) -> None:
        """No-op: each point is a file of its own."""


class WeightsAndBiases:
    """Sends numbers to Weights & Biases; `WANDB_MODE=offline` keeps them in the run's folder. A
    resumed run goes on in the same curves.
    """

    def __init__(self, folder: Path, settings: Mapping[str, Any]) -> None:
        wandb = _imported("wandb")
        name = folder.resolve().name
        self._run = wandb.init(
            project="eyas", name=name, id=name, resume="allow", dir=str(folder), config=settings
        )

    def add(self, decisions: int, values: Mapping[str, float]) -> None:
        """Add a point to each curve."""
        self._run.log(dict(values), step=decisions)

    def end(self) -> None:
        """End the run."""
        self._run.finish()


class MlFlow:
    """Sends numbers to MLflow: to `MLFLOW_TRACKING_URI`, or to its usual place."""

    def __init__(self, folder: Path, settings: Mapping[str, Any]) -> None:
        self._mlflow = _imported("mlflow")
        self._mlflow.set_experiment("eyas")
        self._run = self._mlflow.start_run(run_name=folder.resolve().name)
        params = {name: str(value)[:500] for name, value in _flat("", settings)}
        self._mlflow.log_params(params, run_id=self._run.info.run_id)

    def add(self, decisions: int, values: Mapping[str, float]) -> None:
        """Add a point to each curve."""
        self._mlflow.log_metrics(dict(values), step=decisions, run_id=self._run.info.run_id)

    def end(self) -> None:
        """End the run."""
        self._mlflow.end_run()


def _imported(name: str) -> Any:  # noqa: ANN401  # a module without types
    from importlib import import_module

    try:
        return import_module(name)
    except ImportError:
        raise EyasError(f"train.loggers: {name!r} is not installed: pip install {name}") from None


def _flat(path: str, settings: Mapping[str, Any]) -> list[tuple[str, Any]]:
    """Return nested settings by their dotted paths."""
    found: list[tuple[str, Any]] = []
    for name, value in settings.items():
        own = f"{path}.{name}" if path else name
        found += _flat(own, value) if isinstance(value, Mapping) and value else [(own, value)]
    return found


LOGGERS: Registry[Callable[[Path, Mapping[str, Any]], Logger]] = Registry(
    "train.loggers",
    Callable,  # type: ignore[arg-type]  # a class to `isinstance`
    {
        "tensorboard": f"{__name__}:TensorBoard",
        "wandb": f"{__name__}:WeightsAndBiases",
        "mlflow": f"{__name__}:MlFlow",
    },
)
"""Loggers by name; others are found by their path, `package.module:Class`."""


def _begun(name: str, folder: Path, settings: Mapping[str, Any]) -> Logger:
    """Return a logger.

    Raises:
        EyasError: It is not installed, or cannot reach its server: one line.
    """
    try:
        return LOGGERS.get(name)(folder, settings)
    except EyasError:
        raise
    except Exception as error:  # whatever a library of others raises
        said = f"{type(error).__name__}: {one_line(str(error))}"
        raise EyasError(f"train.loggers: {name!r} cannot begin: {said}") from error


class Loggers:
    """All loggers of a run."""

    def __init__(self, names: tuple[str, ...], folder: Path, settings: Mapping[str, Any]) -> None:
        self._own = [_begun(name, folder, settings) for name in names]

    def add(self, decisions: int, values: Mapping[str, float]) -> None:
        """Add a point to each curve, without numbers that are not known."""
        known = {
            name: float(value)
            for name, value in values.items()
            if name != "decisions" and math.isfinite(value)
        }
        for logger in self._own:
            logger.add(decisions, known)

    def end(self) -> None:
        """End all."""
        for logger in self._own:
            logger.end()
