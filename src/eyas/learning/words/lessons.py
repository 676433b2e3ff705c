"""What the network of the listener is taught: where vehicles are, how they lie and look."""

from typing import Final, NamedTuple

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor
from torch.nn import functional

from eyas.benchmark.policies.listener.detector import STRIDE
from eyas.learning.words.network import ListenerNetwork
from eyas.learning.words.scenes import Scenes, Vehicles, chosen

_ENOUGH: Final = 0.35  # Share of a vehicle that must be visible for it to count as seen
_WIDE: Final = 0.7  # Standard deviation of a peak [cells]

_JITTER: Final = 0.5
"""Standard deviation of the cell in which a vehicle's looks are taught, which is not always the
peak [cells]."""

_WEIGHTS: Final = (1.0, 0.5, 0.5, 0.5, 0.5)
"""Weights of peaks, places, headings, colours and bodies in the loss."""

_LIGHT, _TINT, _NOISE = 0.2, 0.04, 3.0
"""Largest changes of a picture's light and of each colour's, and noise [levels]."""


class Lesson(NamedTuple):
    """B pictures, and what is to be seen in them."""

    picture: Tensor  # Shape (B, 3, H, W)
    peaks: Tensor  # 1 in the middles of vehicles, and less around them, shape (B, C)
    weight: Tensor  # 0 where a vehicle is hidden for the most part, else 1, shape (B, C)
    vehicle: Tensor  # Picture and cell of V vehicles, shape (V, 2)
    cell: Tensor  # Where they are taught, shape (V,)
    place: Tensor  # Shape (V, 2), as all that follow as in `Vehicles`
    heading: Tensor
    colour: Tensor
    body: Tensor


class ListenerLoss(NamedTuple):
    """How wrong a network is."""

    total: Tensor
    found: float  # Share of the vehicles whose cells have odds above 1
    colour: float  # Share of the vehicles with a named colour whose most probable name is right
    body: float  # Share of the vehicles whose most probable body is right


def lesson(
    scenes: Scenes,
    rows: NDArray[np.int64],  # Which are chosen, shape (B,)
    grid: tuple[int, int],
    rng: np.random.Generator,
) -> Lesson:
    """Return some pictures, mirrored, lighter or darker."""
    vehicles = _chosen(scenes.vehicles, rows)
    picture, mirror = _changed(scenes.picture[rows].astype(np.float32), rng)
    size = np.array(picture.shape[:1:-1], np.float32)
    turned = mirror[vehicles.picture]
    place = np.where(turned, size - vehicles.place, vehicles.place)
    heading = np.where(turned, -vehicles.heading, vehicles.heading)
    seen = vehicles.share >= _ENOUGH
    peaks, hidden = (
        _around(place[mask], vehicles.picture[mask], len(rows), grid) for mask in (seen, ~seen)
    )
    weight = ((hidden < 0.3) | (peaks > 0.3)).astype(np.float32)
    moved = place + STRIDE * np.clip(_JITTER * rng.standard_normal(place.shape), -1.0, 1.0)
    column, row = (np.floor(moved[:, axis] / STRIDE).astype(np.int64) for axis in (0, 1))
    cell = np.clip(row, 0, grid[0] - 1) * grid[1] + np.clip(column, 0, grid[1] - 1)
    parts = (vehicles.picture, cell, place, heading, vehicles.colour, vehicles.body)
    taught = (torch.from_numpy(np.ascontiguousarray(part[seen])) for part in parts)
    return Lesson(*map(torch.from_numpy, (picture, peaks, weight)), *taught)


def _chosen(vehicles: Vehicles, rows: NDArray[np.int64]) -> Vehicles:
    """Return the vehicles of some pictures, which are numbered anew."""
    order = np.argsort(rows)
    at = np.searchsorted(rows[order], vehicles.picture)
    mine = rows[order][np.minimum(at, len(rows) - 1)] == vehicles.picture
    return chosen(vehicles, mine)._replace(picture=order[at[mine]])


def _changed(
    picture: NDArray[np.float32], rng: np.random.Generator
) -> tuple[NDArray[np.float32], NDArray[np.bool_]]:
    """Return changed pictures and which are mirrored in columns and rows, shape (B, 2)."""
    count = len(picture)
    mirror = rng.random((count, 2)) < 0.5
    for row, (across, down) in enumerate(mirror.tolist()):
        if across:
            picture[row] = picture[row, ..., ::-1].copy()
        if down:
            picture[row] = picture[row, :, ::-1].copy()
    light = 1.0 + rng.uniform(-_LIGHT, _LIGHT, (count, 1, 1, 1))
    tint = 1.0 + rng.uniform(-_TINT, _TINT, (count, 3, 1, 1))
    noise = rng.standard_normal(picture.shape, np.float32)
    picture = picture * (light * tint).astype(np.float32) + np.float32(_NOISE) * noise
    return np.clip(picture, 0.0, 255.0), mirror


def _around(
    place: NDArray[np.float32], picture: NDArray[np.int64], count: int, grid: tuple[int, int]
) -> NDArray[np.float32]:
    """Return peaks at places, shape (count, C)."""
    peaks = np.zeros((count, *grid), np.float32)
    middle = place / STRIDE - 0.5
    nearest = np.round(middle).astype(np.int64)
    for down in (-2, -1, 0, 1, 2):
        for across in (-2, -1, 0, 1, 2):
            column, row = (nearest + np.array((across, down))).T
            away = np.square(np.stack((column, row), axis=1) - middle).sum(axis=1)
            if down == across == 0:
                away = np.zeros_like(away)
            inside = (column >= 0) & (row >= 0) & (column < grid[1]) & (row < grid[0])
            value = np.exp(-away / (2.0 * _WIDE * _WIDE)).astype(np.float32)
            where = picture[inside], row[inside], column[inside]
            np.maximum.at(peaks, where, value[inside])
    return peaks.reshape(count, -1)


def loss_of(network: ListenerNetwork, shown: Lesson) -> ListenerLoss:
    """Return how wrong a network is."""
    vehicle, places, headings, colours, bodies = network(shown.picture)
    at = shown.vehicle, shown.cell
    count = max(len(shown.cell), 1)
    angle = shown.heading
    double = torch.stack(
        (angle[:, 0] * angle[:, 0] - angle[:, 1] * angle[:, 1], 2.0 * angle[:, 0] * angle[:, 1]), 1
    )
    wanted = torch.cat((angle, double), 1)
    named = shown.colour >= 0
    losses = (
        _peak_loss(vehicle, shown),
        functional.smooth_l1_loss(places[at], shown.place, reduction="sum") / count,
        (headings[at] - wanted).square().sum() / count,
        functional.cross_entropy(colours[at][named], shown.colour[named]),
        functional.cross_entropy(bodies[at], shown.body),
    )
    total = sum(weight * loss for weight, loss in zip(_WEIGHTS, losses, strict=True))
    assert isinstance(total, Tensor)
    with torch.no_grad():
        found = (vehicle[at] > 0.0).float().mean().item()
        colour = (colours[at][named].argmax(1) == shown.colour[named]).float().mean().item()
        body = (bodies[at].argmax(1) == shown.body).float().mean().item()
    return ListenerLoss(total, found, colour, body)


def _peak_loss(vehicle: Tensor, shown: Lesson) -> Tensor:
    """Return the focal loss of "Objects as points", equation 1, for each vehicle."""
    chance = torch.sigmoid(vehicle)
    yes, no = functional.logsigmoid(vehicle), functional.logsigmoid(-vehicle)
    middle = (shown.peaks == 1.0).float()
    less = (1.0 - shown.peaks).square().square()
    gained = middle * (1.0 - chance).square() * yes
    gained = gained + (1.0 - middle) * less * chance.square() * no
    return -(gained * shown.weight).sum() / middle.sum().clamp(min=1.0)
