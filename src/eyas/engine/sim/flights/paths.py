"""The built-in camera paths."""

import math

import numpy as np
from numpy.typing import NDArray

from eyas.engine.sim.flights.path import FlightScene, FlightSketch
from eyas.engine.sim.flights.signals import STEP, averaged, later, steps_in, trailing, tremor
from eyas.lanes import exact

Floats = NDArray[np.float64]


class _Path:
    """What the built-in paths have in common."""

    in_view = 1.0
    searches = False

    def glance(
        self,
        scene: FlightScene,  # The episode
        rng: np.random.Generator,  # Samples reaction, quickness, overshoot and unrest
        haste: float = 1.0,  # Factor on the quickness
        unrest: float = 1.0,  # Factor on how far the target wanders from the middle
    ) -> Floats:
        """Return the point that a pilot looks at: the target, late and not quite held, (M, 3)."""
        reaction = float(rng.uniform(0.12, 0.35))
        frequency, damping = float(rng.uniform(2.0, 4.5)) * haste, float(rng.uniform(0.4, 0.8))
        # People lead what they have seen moving: part of the delay is made up for.
        lead = float(rng.uniform(0.5, 1.0)) * (reaction + 2.0 * damping / frequency)
        speed = np.gradient(scene.target, STEP, axis=0)
        led = scene.target + lead * averaged(speed, 0.5)
        size = (
            0.09 * unrest * math.sqrt(scene.distance * scene.distance + scene.height * scene.height)
        )
        wandering = tremor(len(led), 3, size * float(rng.uniform(0.5, 1.5)), rng)
        return trailing(later(led, reaction), frequency, damping) + wandering

    def lens(self, scene: FlightScene) -> Floats:
        """Return the field of view that does not change, shape (M,)."""
        return np.full(len(scene.time), scene.field_of_view)


class FollowPath(_Path):
    """Goes after the target as a pilot does: late, with overshoot, from behind or from a side."""

    def sketch(self, scene: FlightScene, rng: np.random.Generator) -> FlightSketch:
        """Sample the side, the reaction time, the quickness and the overshoot."""
        bearing = math.pi + float(rng.uniform(-1.2, 1.2))
        drift = float(rng.uniform(-0.04, 0.04))
        goal = scene.beside(bearing + drift * scene.time, scene.distance)
        late = later(goal, float(rng.uniform(0.2, 0.6)))
        place = trailing(late, float(rng.uniform(0.7, 1.4)), float(rng.uniform(0.45, 0.8)))
        place += tremor(len(place), 3, 0.05 * scene.height + 0.3, rng)
        return FlightSketch(place, self.glance(scene, rng), self.lens(scene))


class Orbit(_Path):
    """Circles around the target."""

    def sketch(self, scene: FlightScene, rng: np.random.Generator) -> FlightSketch:
        """Sample the speed, where it begins, the direction and how the circle breathes."""
        radius = max(scene.distance, 8.0)
        turn = float(rng.uniform(2.5, 7.0)) / radius * float(rng.choice([-1.0, 1.0]))
        begin = float(rng.uniform(-math.pi, math.pi))
        breath = 1.0 + tremor(len(scene.time), 1, 0.15, rng)[:, 0]
        place = scene.around(begin + turn * scene.time, radius * breath)
        # The circle does not follow each swerve of the target.
        place[:, :2] += averaged(scene.target[:, :2], 1.5, steady=True) - scene.target[:, :2]
        return FlightSketch(place, self.glance(scene, rng), self.lens(scene))


class FlyBy(_Path):
    """Passes the target on a straight line, turns far from it, and passes it again."""

    def sketch(self, scene: FlightScene, rng: np.random.Generator) -> FlightSketch:
        """Sample the line, the time of the first pass and the time between passes."""
        direction = float(scene.heading[0]) + float(rng.uniform(-math.pi, math.pi))
        period = float(rng.uniform(7.0, 12.0))
        reach = float(rng.uniform(3.0, 6.0)) * period / math.pi
        aside = max(0.6 * scene.distance, 7.0) * float(rng.choice([-1.0, 1.0]))
        passes = float(rng.uniform(0.25, 0.6)) * min(period, float(scene.time[-1]))
        along = reach * exact.sin(math.pi / period * (scene.time - passes))
        east, north = exact.cos(direction), exact.sin(direction)
        place = averaged(scene.target, 2.0, steady=True)
        place[:, 0] += along * east - aside * north
        place[:, 1] += along * north + aside * east
        place[:, 2] += scene.height
        return FlightSketch(place, self.glance(scene, rng), self.lens(scene))


class Rise(_Path):
    """Begins low and near, rises and draws back, as on a crane, and comes down again."""

    def sketch(self, scene: FlightScene, rng: np.random.Generator) -> FlightSketch:
        """Sample the side, how low it begins, how high it goes and how long that takes."""
        bearing = math.pi + float(rng.uniform(-2.0, 2.0))
        lowest = min(float(rng.uniform(4.5, 7.0)), scene.height)
        top = scene.height * float(rng.uniform(1.2, 2.0))
        takes = float(rng.uniform(7.0, 11.0))
        begin = float(rng.uniform(-0.15, 0.1)) * takes
        share = 0.5 - 0.5 * exact.cos(math.pi * np.maximum(scene.time - begin, 0.0) / takes)
        near = max(0.5 * scene.distance, 7.0)
        away = near + (1.3 * scene.distance - near) * share if scene.distance > near else near
        place = averaged(scene.beside(bearing, away), 1.0, steady=True)
        place[:, 2] += lowest + (top - lowest) * share - scene.height
        return FlightSketch(place, self.glance(scene, rng), self.lens(scene))


class Zoom(_Path):
    """Keeps its distance and zooms: wide, near, and back, at moments of its own."""

    def sketch(self, scene: FlightScene, rng: np.random.Generator) -> FlightSketch:
        """Sample the side, how far it zooms, and when."""
        bearing = math.pi + float(rng.uniform(-1.5, 1.5))
        goal = scene.beside(bearing, 1.2 * scene.distance)
        place = trailing(goal, float(rng.uniform(0.6, 1.0)), float(rng.uniform(0.7, 1.0)))
        near = float(rng.uniform(0.3, 0.5))
        wide = float(rng.uniform(1.0, 1.25))
        count = len(scene.time)
        steps: list[float] = []
        is_near = bool(rng.integers(2))
        while len(steps) < count:
            value = scene.field_of_view * (near if is_near else wide)
            steps += [value] * steps_in(float(rng.uniform(2.0, 4.0)))
            is_near = not is_near
        lens = np.minimum(averaged(np.array(steps[:count]), 0.9), 2.6)
        return FlightSketch(place, self.glance(scene, rng, haste=1.4, unrest=0.5), lens)


class HoverAndPan(_Path):
    """Hovers beside the way of the target and turns after it; then flies on to the next place."""

    def sketch(self, scene: FlightScene, rng: np.random.Generator) -> FlightSketch:
        """Sample how long it hovers, and where."""
        count, at = len(scene.time), 0
        goal = np.empty((count, 3))
        while at < count:
            # No longer than the target needs for some 70 m.
            way = np.linalg.norm(scene.target[at:] - scene.target[at], axis=1)
            near = int(np.argmax(way > 70.0)) if bool((way > 70.0).any()) else count - at
            end = at + max(min(steps_in(float(rng.uniform(7.0, 14.0))), near), steps_in(4.0))
            middle = min((at + min(end, count)) // 2, count - 1)
            side = float(scene.heading[middle]) + float(rng.choice([-1.0, 1.0])) * 0.5 * math.pi
            side += float(rng.uniform(-0.6, 0.6))
            goal[at:end] = scene.around(side, scene.distance)[middle]
            at = end
        place = averaged(goal, 2.5) + tremor(count, 3, 0.3, rng)
        return FlightSketch(place, self.glance(scene, rng, haste=0.8), self.lens(scene))


class Search(FollowPath):
    """Follows, but looks for the target first; later it loses and finds it again."""

    in_view = 0.7
    searches = True
