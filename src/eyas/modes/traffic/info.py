"""Say what a recording of traffic holds."""

import json
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from eyas.traffic.config import TrafficConfig
from eyas.traffic.recording import Recording
from eyas.traffic.recording_file import load
from eyas.traffic.smoothing import Tracks, runs, smooth

__all__ = ["describe"]

_STANDING = 0.1
"""Vehicles slower than this stand [m/s]."""

_LASTING = 60.0
"""Tracks of this length can be followed for a long episode [s]."""


def describe(path: Path) -> Iterator[str]:
    """Yield lines about a recording: where it is from, and figures of its vehicles.

    Raises:
        DataFileError: The file cannot be read or is not a recording.
    """
    recording = load(path)
    origin, config = recording.provenance, recording.provenance.config
    yield f"map: {origin.map_name}, seed {origin.map_seed} (roads {origin.graph_hash[:8]})"
    yield f"traffic: {_settings(config)}"
    yield f"made by: SUMO {origin.sumo_version}, Eyas {origin.eyas_version}"
    yield (
        f"duration: {recording.duration:g} s at {recording.rate:g} Hz, "
        f"after {origin.warm_up:g} s that are left out"
    )
    tracks = smooth(recording)
    for name, actors in Counter(recording.vehicle_types).items():
        chosen = np.array([one == name for one in recording.vehicle_types])
        yield f"{name.value}: {_figures(tracks, chosen, actors)}"
    if len(set(recording.vehicle_types)) > 1:
        yield f"all: {_figures(tracks, np.ones(recording.actors, np.bool_), recording.actors)}"
    yield _lasting(recording)


def _settings(config: TrafficConfig) -> str:
    """Return the settings that are not the default ones, in the notation of `--set`."""
    usual = TrafficConfig().model_dump(mode="json")
    values = config.model_dump(mode="json", exclude_defaults=True)
    told = [f"{name}={json.dumps(value)}" for name, value in values.items() if value != usual[name]]
    return " ".join([f"demand={config.demand.value}", *(t for t in told if t[:7] != "demand=")])


def _figures(tracks: Tracks, chosen: np.ndarray, actors: int) -> str:
    present = tracks.present[:, chosen]
    if not present.any():
        return f"{actors} at most, none in the recording"
    speed = np.hypot(*np.moveaxis(tracks.velocity[:, chosen], -1, 0))[present]
    return (
        f"{actors} at most, {present.sum(axis=1).mean():.1f} on average; "
        f"{speed.mean():.1f} m/s on average, {speed.max():.1f} m/s at most; "
        f"standing {100.0 * (speed < _STANDING).mean():.1f} % of the time"
    )


def _lasting(recording: Recording) -> str:
    stays = [
        (last - 1 - first) / recording.rate
        for present in recording.present.T
        for first, last in runs(present)
    ]
    through = sum(stay >= recording.duration for stay in stays)
    long = sum(stay >= _LASTING for stay in stays)
    return (
        f"tracks: {len(stays)}, of which {long} last {_LASTING:g} s or longer and {through} the "
        f"whole recording; median {np.median(stays) if stays else 0.0:.0f} s"
    )
