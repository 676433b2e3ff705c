"""Trains the tracker: traffic, flights of a disturbed oracle, then flights of its own (DAgger).

S. Ross, G. Gordon, D. Bagnell, "A reduction of imitation learning and structured prediction to
no-regret online learning" (AISTATS 2011): what the tracker sees when it flies by itself is what it
must learn.
"""

import io
import json
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path

import numpy as np
import torch

from eyas.benchmark.policies.table import open_policy
from eyas.benchmark.policies.tracker.settings import FLOWN, TrackerSettings
from eyas.benchmark.policies.tracker.tracker import Tracker
from eyas.engine.core.config import updated
from eyas.engine.core.errors import ConfigError
from eyas.engine.core.files import write_atomic
from eyas.engine.core.identity.build import Build, this_build
from eyas.engine.core.rng import stream
from eyas.engine.settings.config import EyasConfig
from eyas.engine.settings.file import load_settings
from eyas.engine.settings.preset import preset_file
from eyas.learning.checkpoint import RunFolder, readable
from eyas.learning.config import TrackerTraining, TrainConfig
from eyas.learning.tracking.driving import Drives, Forecast, driven, taught_forecast
from eyas.learning.tracking.export import export
from eyas.learning.tracking.flights import Oracle, Pilot, Pupil, flown
from eyas.learning.tracking.lessons import Samples, Shots, load, save, taught
from eyas.learning.tracking.network import DetectorNetwork

Say = Callable[[str], None]


def train(config: EyasConfig, folder: Path, *, resume: bool = False, say: Say = print) -> Path:
    """Train a tracker; return the path of the ONNX file. Beside it is another with the same network
    for flown drones, `policy-flown.onnx`.

    A run that is resumed goes on with the next batch of flights or round of lessons, and gives the
    same: pictures and what was learned are kept in the folder.

    Args:
        config: The settings: those of the preset `eyas`, with any seed, size of the pictures and
            `train.tracker`.
        say: Called with a line for each batch, and ten times in each round of lessons.

    Raises:
        EyasError: A setting is wrong, or the folder; one line.
    """
    _refuse_unlike(config)
    files = RunFolder(folder)
    files.begin(config, resume=resume)
    _refuse_other_build(files, folder / "build.json")
    run = _Run(config, folder, say)
    batches = sum(each.flights for each in run.training.rounds)
    say(f"{batches} batches of 32 flights, {run.training.pictures:,} pictures in lessons")
    run.foresee()
    for number in range(len(run.training.rounds)):
        run.round(number)
    run.export(FLOWN, folder / "policy-flown.onnx")
    return files.policy


def _refuse_unlike(config: EyasConfig) -> None:
    """Refuse settings that would change nothing."""
    if not config.tracker.supervised:
        raise ConfigError(
            "tracker.supervised: false is not allowed here: a tracker learns on supervised drones; "
            "'eyas train --preset eyas' also writes policy-flown.onnx, for flown ones"
        )
    seen = config.env.observation
    size = {"width": seen.width, "height": seen.height}
    wanted = updated(load_settings(preset_file("eyas")), {"env": {"observation": size}})
    for name in sorted(EyasConfig.model_fields.keys() - {"mode", "seed", "train"}):
        if getattr(config, name) != getattr(wanted, name):
            raise ConfigError(
                f"{name}: not allowed here: a tracker's flights have all maps, weathers and "
                "targets; besides preset 'eyas' only seed, train.tracker and the width and height "
                "in env.observation can be chosen"
            )
    if seen.width % 16 or 4 * seen.height != 3 * seen.width:
        raise ConfigError(
            f"env.observation: {seen.width}x{seen.height} is not allowed: a tracker sees pictures "
            "of 4 to 3 whose width is a multiple of 16, such as 80x60"
        )
    if TrainConfig.of(config).begin_from is not None:
        raise ConfigError("train.begin_from: not allowed for a tracker: it begins anew")


def _refuse_other_build(files: RunFolder, path: Path) -> None:
    """Note the build that begins a run, or refuse one that another has begun."""
    if path.is_file():
        with readable(path):
            build = Build(**json.loads(path.read_text()))
        files.refuse_other(build)
    write_atomic(path, this_build().model_dump_json(indent=1).encode())


class _Run:
    """A run and how far it has come."""

    def __init__(self, config: EyasConfig, folder: Path, say: Say) -> None:
        self.training: TrackerTraining = TrainConfig.of(config).tracker
        self._config, self._folder, self._say = config, folder, say
        self._begun = time.process_time()
        torch.set_num_threads(1)
        torch.manual_seed(config.seed)
        seen = config.env.observation
        self._network = DetectorNetwork((seen.height, seen.width))
        self._network.to(memory_format=torch.channels_last)  # type: ignore[call-overload]
        self._forecast = Forecast()
        self._shots: list[Shots] = []

    def foresee(self) -> None:
        """Learn where drivers go; or take what is kept of an earlier run."""
        learned = self._folder / "forecast.pt"
        if learned.is_file():
            _restore(self._forecast, learned)
            return
        drives, seed = [], self._config.seed
        for batch in range(self.training.drives):
            drives.append(driven(self._config.env, batch, seed))
            moments = len(drives[-1].past)
            self._tell(f"traffic {batch + 1} of {self.training.drives}: {moments:,} moments")
        every = Drives(*(np.concatenate(parts) for parts in zip(*drives, strict=True)))
        steps, rng = self.training.drive_steps, stream(seed, "tracking drive lessons")
        for step, loss in taught_forecast(self._forecast, every, steps, rng):
            self._tell(f"what drivers do: step {step:,} of {steps:,}: loss {loss:.3f}")
        _keep(self._forecast, learned)

    def round(self, number: int) -> None:
        """Fly and learn; or take what is kept of an earlier run."""
        policy, env = self._folder / "policy.onnx", self._config.env
        make = partial(Oracle, env) if number == 0 else partial(_pupil, policy)
        for _ in range(self.training.rounds[number].flights):
            self._fly(make, number)
        learned = self._folder / f"round-{number}.pt"
        if learned.is_file():
            _restore(self._network, learned)
            return
        self._learn(number)
        self.export(TrackerSettings(), policy)
        _keep(self._network, learned)

    def export(self, settings: TrackerSettings, path: Path) -> None:
        """Write the networks as they are, for a tracker with these settings."""
        export(self._network, self._forecast, self._config.env, settings, path)

    def _fly(self, make: Callable[[np.random.Generator], Pilot], number: int) -> None:
        """Fly the next batch, unless its pictures are there."""
        batch = len(self._shots)
        path = self._folder / f"shots-{batch:03d}.npz"
        if not path.is_file():
            save(next(flown(make, range(batch, batch + 1), self._config.seed)), path)
        self._shots.append(load(path))
        batches = sum(each.flights for each in self.training.rounds)
        pictures = self._shots[-1].flown.sum()
        self._tell(f"round {number}: flights {batch + 1} of {batches}: {pictures:,} pictures")

    def _learn(self, number: int) -> None:
        """Teach in a round, and add how it went to `curve.csv`."""
        each = self.training.rounds[number]
        rng = stream(self._config.seed, "tracking lessons", number)
        path = self._folder / "curve.csv"
        curve = path.read_text() if number > 0 else "round,step,loss,right\n"
        samples = Samples(Shots.joined(self._shots), rng)
        rate = self.training.learning_rate
        for step, loss, right in taught(self._network, samples, each.steps, rate, rng):
            curve += f"{number},{step},{loss:.4f},{right:.4f}\n"
            self._tell(
                f"round {number}: step {step:,} of {each.steps:,}: loss {loss:.3f}, "
                f"right {right:.3f}"
            )
        write_atomic(path, curve.encode())

    def _tell(self, line: str) -> None:
        self._say(f"{line}  CPU {time.process_time() - self._begun:.0f} s")


def _keep(network: torch.nn.Module, path: Path) -> None:
    """Write what a network has learned."""
    content = io.BytesIO()
    torch.save(network.state_dict(), content)
    write_atomic(path, content.getvalue())


def _restore(network: torch.nn.Module, path: Path) -> None:
    """Take what one has learned from a file of `_keep`; one of others runs no code."""
    with readable(path):
        network.load_state_dict(torch.load(path, weights_only=True))


def _pupil(policy: Path, rng: np.random.Generator) -> Pupil:
    tracker = open_policy(str(policy), {})
    assert isinstance(tracker, Tracker)
    return Pupil(tracker, rng)
