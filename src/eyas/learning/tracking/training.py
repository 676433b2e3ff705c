"""Trains the tracker: flights of a disturbed oracle, then flights of its own (DAgger).

S. Ross, G. Gordon, D. Bagnell, "A reduction of imitation learning and structured prediction to
no-regret online learning" (AISTATS 2011): what the tracker sees when it flies by itself is what it
must learn.
"""

import io
import time
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import Annotated

import numpy as np
import torch
from pydantic import Field

from eyas.core.config import Config
from eyas.core.errors import DataFileError
from eyas.core.files import write_atomic
from eyas.core.rng import stream
from eyas.evaluation.policies.policy import env_config
from eyas.evaluation.policies.table import open_policy
from eyas.evaluation.policies.tracker.settings import TrackerSettings
from eyas.evaluation.policies.tracker.tracker import OBSERVED, Tracker
from eyas.learning.checkpoint import readable
from eyas.learning.tracking.export import export
from eyas.learning.tracking.flights import Pilot, flown
from eyas.learning.tracking.lessons import taught
from eyas.learning.tracking.network import DetectorNetwork
from eyas.learning.tracking.pilots import Oracle, Pupil
from eyas.learning.tracking.samples import Samples
from eyas.learning.tracking.shots import Shots, load, save

__all__ = ["Round", "TrackingConfig", "train"]

Count = Annotated[int, Field(ge=1, le=100_000_000)]


class Round(Config):
    """Flights, then steps of learning from all pictures there are."""

    batches: Annotated[int, Field(ge=0, le=100_000)]
    """Batches of flights, of 32 flights each; the first round needs some."""
    steps: Count
    """Steps of learning, of 128 pictures each."""


class TrackingConfig(Config):
    """How a tracker is trained."""

    seed: Annotated[int, Field(ge=0)] = 0
    width: Annotated[int, Field(ge=16, le=640, multiple_of=16)] = 80
    """Of the pictures [pixels]; their height is three quarters of it."""
    rounds: Annotated[tuple[Round, ...], Field(min_length=1)] = (
        Round(batches=18, steps=1000),
        Round(batches=12, steps=900),
        Round(batches=0, steps=1600),
    )
    """The first has flights of the oracle, later ones add flights of what was learned before."""
    rate: Annotated[float, Field(gt=0.0, le=1.0)] = 2e-3
    """Largest rate of learning."""
    tracker: TrackerSettings = TrackerSettings()


def train(config: TrackingConfig, folder: Path) -> Iterator[str]:
    """Train, yielding lines of progress with the CPU time; `policy.onnx` is then in the folder.

    A training that was interrupted goes on with the next batch of flights or round of lessons when
    it is begun again: pictures and what was learned are kept in the folder.

    Args:
        config: The settings.
        folder: Is made if it does not exist.

    Raises:
        DataFileError: A training with other settings is there.
    """
    folder.mkdir(parents=True, exist_ok=True)
    said, settings = folder / "tracking.json", config.model_dump_json(indent=1).encode()
    if said.is_file() and said.read_bytes() != settings:
        raise DataFileError(f"{said}: a training with other settings is in this folder")
    write_atomic(said, settings)
    torch.set_num_threads(1)
    torch.manual_seed(config.seed)
    height = config.width * 3 // 4
    image = {**OBSERVED, "width": config.width, "height": height}
    env = env_config({"actions": "velocity", "observation": image, "action_repeat": 4})
    network = DetectorNetwork((height, config.width))
    network.to(memory_format=torch.channels_last)  # type: ignore[call-overload]
    shots: list[Shots] = []
    for number, each in enumerate(config.rounds):
        make = partial(Oracle, env) if number == 0 else partial(_pupil, folder / "policy.onnx")
        for batch in range(len(shots), len(shots) + each.batches):
            shots.append(_kept(folder / f"shots-{batch:03d}.npz", make, batch, config.seed))
            yield f"round {number}: batch {batch}, {shots[-1].flown.sum()} pictures"
        learned = folder / f"round-{number}.pt"
        if learned.is_file():
            with readable(learned):  # a file of others runs no code
                network.load_state_dict(torch.load(learned, weights_only=True))
            continue
        yield from _lessons(config, number, network, Shots.joined(shots), folder)
        export(network, env, config.tracker, folder / "policy.onnx")
        content = io.BytesIO()
        torch.save(network.state_dict(), content)
        write_atomic(learned, content.getvalue())


def _lessons(
    config: TrackingConfig, number: int, network: DetectorNetwork, shots: Shots, folder: Path
) -> Iterator[str]:
    """Teach in a round; yield lines of progress, and add them to `curve.csv`."""
    rng = stream(config.seed, "tracking lessons", number)
    path, begun = folder / "curve.csv", time.process_time()
    curve = path.read_text() if number > 0 else "round,step,loss,right\n"
    lessons = taught(network, Samples(shots, rng), config.rounds[number].steps, config.rate, rng)
    for step, loss, right in lessons:
        curve += f"{number},{step},{loss:.4f},{right:.4f}\n"
        spent = time.process_time() - begun
        yield f"round {number}: step {step}: loss {loss:.3f}, right {right:.3f}, CPU {spent:.0f} s"
    write_atomic(path, curve.encode())


def _pupil(policy: Path, rng: np.random.Generator) -> Pupil:
    tracker = open_policy(str(policy), {})
    assert isinstance(tracker, Tracker)
    return Pupil(tracker, rng)


def _kept(path: Path, make: Callable[[np.random.Generator], Pilot], batch: int, seed: int) -> Shots:
    """Return a batch of flights, from its file if it has been flown before."""
    if not path.is_file():
        save(next(flown(make, range(batch, batch + 1), seed)), path)
    return load(path)
