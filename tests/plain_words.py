"""A reader of phrases that shares no code with what generates them.

It takes words by their plain meaning, without the generator's margins, and tells which of the
movers that have a part in a picture fit.
"""

import math
from functools import lru_cache

import numpy as np

from eyas.engine.targets.catalogue import MODELS, kind_of
from eyas.engine.targets.colour_names import COLOUR_NAMES

CARS = {
    "BmwX5Simple": "suv",
    "RangeRoverSportSVRSimple": "suv",
    "CitroenCZeroSimple": "small_car",
    "ToyotaPriusSimple": "hatchback",
    "LincolnMKZSimple": "sedan",
    "TeslaModel3Simple": "sedan",
}
ON_ROADS = {
    **CARS,
    "MercedesBenzSprinterSimple": "van",
    "BusSimple": "bus",
    "TruckSimple": "truck",
    "TruckTrailerSimple": "truck",
    "TruckTankSimple": "truck",
    "ScooterSimple": "motorcycle",
    "MotorbikeSimple": "motorcycle",
}


def called(word, name):
    own = ON_ROADS.get(name, "person" if name.startswith("Pedestrian") else "robot")
    if word == "vehicle":
        return name in ON_ROADS
    return name in CARS if word == "car" else own == word


def nearest_name(colour):
    def away(name):
        other = COLOUR_NAMES[name]
        red = (colour[0] + other[0]) / 2
        squares = [(a - b) ** 2 for a, b in zip(colour, other, strict=True)]
        return (2 + red) * squares[0] + 4 * squares[1] + (3 - red) * squares[2]

    return min(COLOUR_NAMES, key=away)


def does(word, mover):
    moves, turn = mover["speed"] >= mover["slowest"], mover["yaw_rate"]
    return {
        "standing": not moves,
        "moving": moves,
        "straight": moves and abs(turn) < 0.15,
        "left_turn": moves and turn >= 0.15,
        "right_turn": moves and turn <= -0.15,
    }[word]


def bears(word, mover, reference):
    if mover is reference:
        return False
    east, north = mover["middle"] - reference["middle"]
    cosine, sine = math.cos(reference["yaw"]), math.sin(reference["yaw"])
    ahead, left = cosine * east + sine * north, cosine * north - sine * east
    length = (mover["size"][0] + reference["size"][0]) / 2
    width = (mover["size"][1] + reference["size"][1]) / 2
    if word == "beside":
        return abs(ahead) < length and abs(left) < width + 5.0
    along = ahead if word == "ahead" else -ahead
    return 0.0 < along < length + 15.0 and abs(left) < width + 0.5


def those_who_fit(claim, movers):
    """Return the movers that a claim fits by the plain meaning of its words."""
    fit = [one for one in movers if called(claim.body, one["name"])]
    if claim.colour is not None:
        fit = [one for one in fit if one["colour"] == claim.colour]
    if claim.doing is not None:
        fit = [one for one in fit if does(claim.doing, one)]
    if claim.other is not None:
        (reference,) = those_who_fit(claim.other, movers)
        fit = [one for one in fit if bears(claim.bearing, one, reference)]
    if claim.place is not None:
        axis = claim.place in ("top", "bottom", "topmost", "bottommost")
        sign = -1 if claim.place in ("right", "bottom", "rightmost", "bottommost") else 1
        if str(claim.place).endswith("most"):
            first = min((sign * one["place"][axis] for one in fit), default=0.0)
            fit = [one for one in fit if sign * one["place"][axis] == first]
        else:
            fit = [one for one in fit if sign * (one["place"][axis] - 0.5) < 0.0]
    return fit


@lru_cache
def grid(length, width, height, ahead):
    """Return points all over the box of a mover, in its own frame [m]."""
    x = np.linspace(ahead - length / 2, ahead + length / 2, 7)
    y, z = np.linspace(-width / 2, width / 2, 4), np.linspace(0.0, height, 3)
    return np.stack(np.meshgrid(x, y, z, indexing="ij"), axis=-1).reshape(-1, 3)


def in_picture(simulation, tracker):
    """Return what a camera has in view, by points of each mover that are in its picture."""
    actors, model = simulation.actors_around(tracker)
    colours = simulation.looks_around(tracker).colour[0]
    cameras = simulation.snapshot.cameras
    camera, axes = cameras.position[tracker], cameras.rotation[tracker]
    wide = math.tan(cameras.field_of_view[tracker] / 2)
    target, movers = int(simulation.snapshot.targets.actor[tracker]), []
    near = np.linalg.norm(actors.position[0] - camera, axis=1) < 110.0
    for actor in np.flatnonzero(near & actors.present[0]).tolist():
        kind, size = kind_of(int(model[actor])), MODELS[int(model[actor])].size
        yaw = float(actors.yaw[0, actor])
        cosine, sine = math.cos(yaw), math.sin(yaw)
        turn = np.array([[cosine, -sine, 0.0], [sine, cosine, 0.0], [0.0, 0.0, 1.0]])
        points = grid(*size, kind.ahead) @ turn.T + actors.position[0, actor]
        seen = (points - camera) @ axes
        depth = np.maximum(seen[:, 0], 1e-6)
        place = np.stack(
            [0.5 - seen[:, 1] / depth / wide / 2, 0.5 - seen[:, 2] / depth / wide / 1.5], axis=1
        )
        shown = (seen[:, 0] > 0.0) & ((place > 0.0) & (place < 1.0)).all(axis=1)
        if not shown.any() and actor != target:
            continue
        middle = seen.mean(axis=0)
        movers.append(
            {
                "actor": actor,
                "name": MODELS[int(model[actor])].name,
                "colour": nearest_name(colours[actor].tolist()),
                "speed": float(actors.speed[0, actor]),
                "slowest": kind.slowest,
                "yaw_rate": float(actors.yaw_rate[0, actor]),
                "yaw": yaw,
                "middle": points[:, :2].mean(axis=0),
                "size": size,
                "place": (0.5 - middle[1] / middle[0] / wide / 2,
                          0.5 - middle[2] / middle[0] / wide / 1.5),
            }
        )  # fmt: skip
    return movers
