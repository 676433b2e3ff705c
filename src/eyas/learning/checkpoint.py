"""The folder of a training run: settings, checkpoint, curve and network."""

import csv
import io
import sys
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any, Protocol

import torch

from eyas.engine.core.errors import DataFileError, OutputError
from eyas.engine.core.files import refusals, write_atomic
from eyas.engine.core.identity.build import Build, this_build
from eyas.engine.settings.config import EyasConfig
from eyas.engine.settings.file import load_settings, save_settings

Row = dict[str, float]


class Stateful(Protocol):
    """What remembers something from block to block."""

    def state_dict(self) -> dict[str, Any]:
        """Return it."""

    def load_state_dict(self, state: dict[str, Any], /) -> Any:  # noqa: ANN401  # not looked at
        """Remember it."""


_NOT_LEARNED = ("robotics", "engine/exports", "engine/overlay", "engine/video")
"""Rooms that have no part in a training run."""


@dataclass
class TrainingProgress:
    """How far a run has come."""

    stage: int = 0
    block: int = 0  # Number of the next block
    decisions: int = 0  # Decisions of all stages
    stage_decisions: int = 0  # Decisions of the current stage
    rows: list[Row] = field(default_factory=list)  # Rows of the curve, one for each block


class RunFolder:
    """A folder with `config.json`, `checkpoint.pt`, `curve.csv`, `policy.onnx`, `tensorboard/`."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.policy = path / "policy.onnx"
        self._config = path / "config.json"
        self._checkpoint = path / "checkpoint.pt"

    def begin(self, config: EyasConfig, *, resume: bool) -> None:
        """Make the folder, or check that it holds a run with these settings.

        Raises:
            OutputError: There is a run in it already, or none to resume, or one with other
                settings.
        """
        if not resume and self._config.exists():
            raise OutputError(f"{self.path}: has a run already; continue it with --resume")
        if resume:
            if not self._config.exists():
                raise OutputError(f"{self.path}: there is no run to resume")
            if load_settings(self._config, trust=True) != config:  # only compared
                raise OutputError(
                    f"{self.path}: the run in it has other settings, see its config.json; only a "
                    "run with the same settings can be resumed"
                )
            return
        with refusals(self.path):
            self.path.mkdir(parents=True, exist_ok=True)
        save_settings(config, self._config)

    def save(
        self,
        progress: TrainingProgress,
        parts: Mapping[str, Stateful],  # What learns, `network` among them
        code: Sequence[str] = (),
    ) -> None:
        """Write a checkpoint and the curve."""
        data = io.BytesIO()
        torch.save(
            {
                "build": this_build().model_dump(),
                "code": list(code),
                "progress": asdict(progress),
                **{name: part.state_dict() for name, part in parts.items()},
            },
            data,
        )
        write_atomic(self._checkpoint, data.getvalue())
        text = io.StringIO()
        writer = csv.DictWriter(text, list(progress.rows[0]), lineterminator="\n")
        writer.writeheader()
        writer.writerows(progress.rows)
        write_atomic(self.path / "curve.csv", text.getvalue().encode())

    def load(self, parts: Mapping[str, Stateful], code: Sequence[str] = ()) -> TrainingProgress:
        """Return how far the run has come; set what learns as it was. Arguments as of `save`.

        Raises:
            DataFileError: The checkpoint cannot be read.
            OutputError: Another build of Eyas has made it, which may compute other blocks.
        """
        if not self._checkpoint.exists():
            return TrainingProgress()
        with readable(self._checkpoint):
            saved: dict[str, Any] = torch.load(self._checkpoint, "cpu", weights_only=True)
            build, taught = Build(**saved["build"]), saved["code"]
        self.refuse_other(build)
        if taught != list(code):
            raise OutputError(
                f"{self.path}: taught by other code, {', '.join(taught) or 'none of your own'}; "
                "resume with that code, or begin another run"
            )
        with readable(self._checkpoint):
            for name, part in parts.items():
                part.load_state_dict(saved[name])
            kept = saved["progress"]
            # The same objects as in a run that was not resumed: so pickle writes the same bytes.
            kept["rows"] = [{sys.intern(name): row[name] for name in row} for row in kept["rows"]]
            return TrainingProgress(**kept)

    def refuse_other(self, build: Build) -> None:
        """Refuse to go on with what another build has begun: it may compute other numbers.

        Raises:
            OutputError: The build differs from this one in a room that learning depends on.
        """
        if differs := build.difference(this_build(), without=_NOT_LEARNED, libraries=True):
            raise OutputError(
                f"{self.path}: trained by build {build.id} of Eyas, which differs from this one in "
                f"{differs}; resume with that build, or begin another run"
            )

    def load_network(self, network: torch.nn.Module) -> None:
        """Set a network to what this run has learned.

        Raises:
            DataFileError: There is no checkpoint, or one of another network.
        """
        with readable(self._checkpoint):
            saved = torch.load(self._checkpoint, "cpu", weights_only=True)
            network.load_state_dict(saved["network"])


@contextmanager
def readable(path: Path) -> Iterator[None]:
    """Say in one line what is wrong with a checkpoint.

    Raises:
        DataFileError: It cannot be read.
    """
    try:
        yield
    except FileNotFoundError:
        raise DataFileError(f"{path}: no such file") from None
    except Exception as error:  # PyTorch has many kinds
        line = " ".join(str(error).split())[:200]
        raise DataFileError(f"{path}: not a checkpoint of this network: {line}") from error
