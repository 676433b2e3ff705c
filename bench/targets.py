"""What targets cost: their poses, and pictures with many of them.

    python bench/targets.py

Times of poses are of wall clock and of the process on all cores; the fastest of several repeats.
"""

import time
from collections.abc import Callable

import numpy as np

from eyas.engine.core.config import validated
from eyas.engine.sim.build import build_simulation
from eyas.engine.sim.config import SimConfig
from eyas.engine.sim.worlds import together
from eyas.engine.state.draw import Picture
from eyas.engine.state.motion import ActorState
from eyas.engine.targets.catalogue import kind_index, models_of
from eyas.engine.targets.kind import Looks
from eyas.engine.targets.rig import Rigs

WORLDS, ACTORS, REPEATS = 1000, 40, 15

CASES = {
    "40 cars": ["passenger"] * 40,
    "40 pedestrians": ["Pedestrian"] * 40,
    "a mix": [*["passenger"] * 24, *["bus", "truck", "trailer", "motorcycle"] * 2,
              *["Pedestrian"] * 6, "BB-8", "Mantis"],
}  # fmt: skip


def poses() -> None:
    """Pose all actors of 1,000 worlds."""
    for name, kinds in CASES.items():
        kind = np.array([kind_index(k) for k in kinds], np.int32)
        rigs, rng = Rigs(kind), np.random.default_rng(1)
        actors, shape = ActorState.create(WORLDS, ACTORS), (WORLDS, ACTORS)
        actors.position[:] = rng.uniform(-300.0, 300.0, (*shape, 3))
        actors.yaw[:], actors.speed[:] = rng.uniform(-3.0, 3.0, shape), 8.0
        actors.travelled[:], actors.present[:] = rng.uniform(0.0, 99.0, shape), True
        own = [models_of(k) for k in kind.tolist()]
        model = np.stack([rng.integers(m.start, m.stop, WORLDS) for m in own], axis=1)
        looks = Looks(model.astype(np.int32), np.full((*shape, 3), 0.5, np.float32))
        drawn = rigs.draw_list(WORLDS)
        wall, cpu = _fastest(lambda r=rigs, d=drawn, k=looks, a=actors: r.pose(a, k, d))
        assert np.isfinite(drawn.pose).all()
        print(
            f"poses of {WORLDS} worlds x {name}: {1e3 * wall:.1f} ms, {1e3 * cpu:.1f} ms of CPU; "
            f"{drawn.part.shape[1] / ACTORS:.1f} slots an actor"
        )


def pictures() -> None:
    """Draw 84 x 84 pictures of a street with 40 cars, and with pedestrians and robots besides."""
    extras = [
        {"kind": "Pedestrian", "count": 20},
        *({"kind": robot, "count": 2} for robot in ("Create", "BB-8", "Mantis", "Scout", "Hoap2")),
    ]
    worlds = [_crowded([]), _crowded(extras)]
    times = [np.inf, np.inf]
    for _ in range(REPEATS):
        for k, draw in enumerate(worlds):
            times[k] = min(times[k], _fastest(draw, 3)[1])
    cars, everyone = times
    print(
        f"a picture with 40 cars in view: {1e6 * cars:.0f} us of CPU; with 20 pedestrians and 10 "
        f"robots besides: {1e6 * everyone:.0f} us; the frame rate falls by "
        f"{100.0 * (1.0 - cars / everyone):.0f} %"
    )


def _crowded(extras: list[dict[str, object]]) -> Callable[[], None]:
    """Return what draws a picture in which all actors are seen, on a plot of 36 x 36 m."""
    settings = {"extras": extras, "traffic": {"max_vehicles": 40, "group_size": 40}}
    simulation = build_simulation(validated(SimConfig, settings), together(1))
    simulation.reset()
    motion, rng = simulation.traffic.motion, np.random.default_rng(2)
    count, places = len(motion.kind), motion.places(np.arange(motion.samples))
    target = int(simulation.snapshot.targets.actor[0])
    centre = simulation.snapshot.targets.position[0]
    for axis, middle in (("x", centre[0]), ("y", centre[1])):
        place = middle + rng.uniform(-18.0, 18.0, count)
        place[target] = middle
        motion.track[axis][places] = place
    motion.footing["present"] = 1.0
    camera = simulation.snapshot.cameras
    camera.position[0] = centre + np.array([0.0, 0.0, 50.0])
    camera.rotation[0] = np.array([[0, 0, 1], [0, 1, 0], [-1, 0, 0]], np.float64)
    picture = Picture.create(1, 84, 84, object_id=True, actors=count)
    chosen = np.zeros(1, np.int32)
    simulation.draw(chosen, picture)
    seen = int((picture.actor_pixels[0, :, 0] > 0).sum())
    print(f"{seen} of {count} actors are seen")
    plain = Picture.create(1, 84, 84)
    return lambda: simulation.draw(chosen, plain)


def _fastest(work: Callable[[], object], repeats: int = REPEATS) -> tuple[float, float]:
    """Return wall clock and CPU time of the fastest of some repeats [s]."""
    wall = cpu = np.inf
    for _ in range(repeats):
        before = time.perf_counter(), time.process_time()
        work()
        wall = min(wall, time.perf_counter() - before[0])
        cpu = min(cpu, time.process_time() - before[1])
    return wall, cpu


if __name__ == "__main__":
    poses()
    pictures()
