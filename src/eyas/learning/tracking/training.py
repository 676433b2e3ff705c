"""Trains the tracker: flights of a disturbed oracle, then flights of its own (DAgger).

S. Ross, G. Gordon, D. Bagnell, "A reduction of imitation learning and structured prediction to
no-regret online learning" (AISTATS 2011): what the tracker sees when it flies by itself is what it
must learn.
"""

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Annotated

import numpy as np
import torch
from pydantic import Field

from eyas.core.config import Config
from eyas.core.files import write_atomic
from eyas.core.rng import stream
from eyas.evaluation.policies.policy import env_config
from eyas.evaluation.policies.table import open_policy
from eyas.evaluation.policies.tracker.settings import TrackerSettings
from eyas.evaluation.policies.tracker.tracker import FIXED, Tracker
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

    batches: Count
    """Batches of flights, of 32 flights each."""
    steps: Count
    """Steps of learning, of 128 pictures each."""


class TrackingConfig(Config):
    """How a tracker is trained."""

    seed: Annotated[int, Field(ge=0)] = 0
    width: Annotated[int, Field(ge=16, le=640)] = 80
    """Of the pictures [pixels], a multiple of 4; their height is three quarters of it."""
    rounds: Annotated[tuple[Round, ...], Field(min_length=1)] = (
        Round(batches=18, steps=800),
        Round(batches=12, steps=1800),
    )
    """The first has flights of the oracle, later ones add flights of what was learned before."""
    rate: Annotated[float, Field(gt=0.0, le=1.0)] = 2e-3
    """Largest rate of learning."""
    tracker: TrackerSettings = TrackerSettings()


def train(config: TrackingConfig, folder: Path) -> Iterator[str]:
    """Train, yielding lines of progress; `policy.onnx` is then in the folder.

    Pictures are kept in the folder, each batch when it is whole, and taken from there when the same
    training is begun again.

    Args:
        config: The settings.
        folder: Is made if it does not exist.
    """
    folder.mkdir(parents=True, exist_ok=True)
    write_atomic(folder / "tracking.json", config.model_dump_json(indent=1).encode())
    torch.set_num_threads(1)
    torch.manual_seed(config.seed)
    height = config.width * 3 // 4
    image = {**FIXED["observation"], "width": config.width, "height": height}
    env = env_config({**FIXED, "observation": image, "action_repeat": 4})
    network = DetectorNetwork((height, config.width)).to(memory_format=torch.channels_last)
    policy, shots = folder / "policy.onnx", list[Shots]()
    for number, each in enumerate(config.rounds):
        make: Callable[[np.random.Generator], Pilot] = lambda rng: Oracle(env, rng)  # noqa: E731
        if number > 0:
            make = lambda rng: Pupil(_tracker(policy), rng)  # noqa: E731
        for batch in range(len(shots), len(shots) + each.batches):
            shots.append(_kept(folder / f"shots-{batch:03d}.npz", make, batch, config.seed))
            yield f"round {number}: batch {batch}, {shots[-1].flown.sum()} pictures"
        rng = stream(config.seed, "tracking lessons", number)
        samples = Samples(Shots.joined(shots), rng)
        for line in taught(network, samples, each.steps, config.rate, rng):
            yield f"round {number}: {line}"
        export(network, env, config.tracker, policy)


def _tracker(path: Path) -> Tracker:
    policy = open_policy(str(path), {})
    assert isinstance(policy, Tracker)
    return policy


def _kept(path: Path, make: Callable[[np.random.Generator], Pilot], batch: int, seed: int) -> Shots:
    """Return a batch of flights, from its file if it has been flown before."""
    if not path.is_file():
        save(next(flown(make, range(batch, batch + 1), seed)), path)
    return load(path)
