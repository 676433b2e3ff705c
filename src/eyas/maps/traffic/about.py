"""What is in a recording of traffic: where it is from, and figures of its vehicles."""

import json
from collections import Counter
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from eyas.engine.state.roads import RoadNetwork
from eyas.engine.traffic.config import TrafficConfig
from eyas.engine.traffic.lamps import LaneMap
from eyas.engine.traffic.recording import TrafficRecording
from eyas.engine.traffic.recording_file import load
from eyas.engine.traffic.smoothing import Tracks, runs, smooth

_STANDING = 0.1  # Vehicles slower than this stand [m/s]

_LASTING = 60.0  # Tracks of this length can be followed for a long episode [s]


@dataclass(frozen=True, slots=True)
class ClassFigures:
    """Figures of some vehicles; those of a recording in which none of them is are 0."""

    most: int  # Largest number that are there at once
    mean: float  # Mean number that are there
    mean_speed: float  # [m/s]
    top_speed: float  # [m/s]
    standing: float  # Share of their time in which they stand


@dataclass(frozen=True, slots=True)
class TrafficFacts:
    """What there is to say about a recording."""

    map: str
    map_seed: int
    roads: str  # Hash of the road graph
    traffic: dict[str, Any]  # Demand, and the settings that are not the default ones
    sumo_version: str  # Empty: it is of recorded vehicles
    eyas_version: str
    duration: float  # [s]
    rate: float  # Samples per second [Hz]
    warm_up: float  # Time before the recording, which is left out [s]
    vehicles: dict[str, ClassFigures]  # Figures by class; of several classes also `all`
    tracks: int
    lasting_tracks: int  # Number of tracks of a minute or longer
    whole_tracks: int  # Number of tracks as long as the recording
    median_track: float  # Median length of a track [s]


def about(path: Path) -> TrafficFacts:
    """Return what there is to say about a recording.

    Raises:
        DataFileError: The file cannot be read or is not a recording.
    """
    recording = load(path)
    origin = recording.provenance
    stays = [
        (last - 1 - first) / recording.rate
        for present in recording.present.T
        for first, last in runs(present)
    ]
    return TrafficFacts(
        map=origin.map_name,
        map_seed=origin.map_seed,
        roads=origin.graph_hash,
        traffic=_settings(origin.config),
        sumo_version=origin.sumo_version,
        eyas_version=origin.eyas_version,
        duration=recording.duration,
        rate=recording.rate,
        warm_up=origin.warm_up,
        vehicles=_vehicles(recording),
        tracks=len(stays),
        lasting_tracks=sum(stay >= _LASTING for stay in stays),
        whole_tracks=sum(stay >= recording.duration for stay in stays),
        median_track=float(np.median(stays)) if stays else 0.0,
    )


def lines_of(said: TrafficFacts) -> list[str]:
    """Return what `eyas traffic info` prints."""
    others = {name: value for name, value in said.traffic.items() if name != "demand"}
    settings = (f"{name}={json.dumps(value)}" for name, value in others.items())
    return [
        f"map: {said.map}, seed {said.map_seed} (roads {said.roads[:8]})",
        " ".join([f"traffic: demand={said.traffic['demand']}", *settings]),
        f"made by: {f'SUMO {said.sumo_version}, ' if said.sumo_version else ''}"
        f"Eyas {said.eyas_version}",
        f"duration: {said.duration:g} s at {said.rate:g} Hz, "
        f"after {said.warm_up:g} s that are left out",
        *(f"{name}: {_line(figures)}" for name, figures in said.vehicles.items()),
        f"tracks: {said.tracks}, of which {said.lasting_tracks} last {_LASTING:g} s or longer and "
        f"{said.whole_tracks} the whole recording; median {said.median_track:.0f} s",
    ]


def _settings(config: TrafficConfig) -> dict[str, Any]:
    """Return the demand, and the settings that are not the default ones."""
    usual = TrafficConfig().model_dump(mode="json")
    values = config.model_dump(mode="json", exclude_defaults=True)
    changed = {name: value for name, value in values.items() if value != usual[name]}
    return {"demand": config.demand.value, **changed}


def _vehicles(recording: TrafficRecording) -> dict[str, ClassFigures]:
    tracks = smooth(recording)
    found = {}
    for name, actors in Counter(recording.vehicle_types).items():
        chosen = np.array([one == name for one in recording.vehicle_types])
        found[name.value] = _figures(tracks, chosen, actors)
    if len(found) > 1:
        everyone = np.ones(recording.actors, np.bool_)
        found["all"] = _figures(tracks, everyone, recording.actors)
    return found


def _figures(tracks: Tracks, chosen: NDArray[np.bool_], actors: int) -> ClassFigures:
    present = tracks.present[:, chosen]
    if not present.any():
        return ClassFigures(actors, 0.0, 0.0, 0.0, 0.0)
    speed = np.hypot(*np.moveaxis(tracks.velocity[:, chosen], -1, 0))[present]
    return ClassFigures(
        most=actors,
        mean=float(present.sum(axis=1).mean()),
        mean_speed=float(speed.mean()),
        top_speed=float(speed.max()),
        standing=float((speed < _STANDING).mean()),
    )


def _line(figures: ClassFigures) -> str:
    if not figures.mean:
        return f"{figures.most} at most, none in the recording"
    return (
        f"{figures.most} at most, {figures.mean:.1f} on average; "
        f"{figures.mean_speed:.1f} m/s on average, {figures.top_speed:.1f} m/s at most; "
        f"standing {100.0 * figures.standing:.1f} % of the time"
    )


def coverage(recording: TrafficRecording, network: RoadNetwork) -> str:
    """Return a sentence about the vehicles of a recording, and on which streets they drive."""
    every = max(round(0.5 * recording.rate), 1)  # who is on a lane for less is missed
    here = recording.present[::every]
    places = recording.position[::every][here]
    lanes = LaneMap(network).at(places[:, 0], places[:, 1])
    driven = np.zeros(len(network.edges), np.bool_)
    driven[network.lane_edge[lanes[lanes >= 0]]] = True
    rows = np.repeat(np.arange(len(network.lane_width)), np.diff(network.lane_first))
    first = network.lane_index == 0
    length = shapely.length(shapely.linestrings(network.lane_points, indices=rows))[first]
    share = length[driven[network.lane_edge[first]]].sum() / length.sum()
    most = int(here.sum(axis=1).max())
    return (
        f"traffic: up to {most} vehicles at a time ({here.sum(axis=1).mean():.0f} on average) "
        f"for {recording.duration / 60.0:.0f} minutes, on {100.0 * share:.0f} % of the streets' "
        "length, recorded with SUMO; other traffic on first use"
    )
