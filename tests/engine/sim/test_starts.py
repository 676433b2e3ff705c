"""No episode begins inside anything."""

from dataclasses import replace
from functools import partial

import numpy as np
import pytest

from eyas.engine.core.errors import SpawnError
from eyas.engine.sensors.obstacles import Solids, solids_of
from eyas.engine.sim.build import assets_of, tracker_in
from eyas.engine.sim.config import SimConfig
from eyas.engine.sim.simulation import Simulation
from eyas.engine.sim.starts import AROUND_BODY, starts_in
from eyas.engine.sim.worlds import Worlds, each_alone, together
from eyas.engine.state.scene import ObjectClass, Scene
from eyas.engine.state.snapshot import Snapshot
from eyas.engine.state.terrain import Terrain
from eyas.engine.world.build.scene_builder import SceneBuilder

TRACKERS = 200


def simulation_with(solids, config: SimConfig, world_of: np.ndarray) -> Simulation:
    """A simulation on its map, with what stands as given; None: as it is."""
    assets = assets_of(config, world_of)
    if solids is not None:
        assets = replace(assets, solids=lambda: solids)
    return Simulation(config, assets, tracker_in(config, assets), world_of)


def slab(top: float, half: float = 1000.0) -> Solids:
    """A block over everything, as high as asked."""
    builder = SceneBuilder("slab", 0, (1.0, 1.0), Terrain.flat(0.0))
    owner = builder.add(ObjectClass.BUILDING)
    corners = [(-half, -half), (half, -half), (half, half), (-half, half)]
    builder.add_prism(corners, -10.0, top, owner)
    return solids_of(builder.build(Scene.empty().network))


NOTHING = partial(slab, -9.0)


@pytest.fixture(scope="module")
def starts():
    """Positions and times of many starts: as they are, and if nothing stood on the map."""
    told = []
    for solids in (None, NOTHING()):
        simulation = simulation_with(solids, SimConfig(seed=7), each_alone(TRACKERS))
        simulation.reset()
        told.append(simulation)
    return told


def test_starts_inside_something_are_drawn_again_and_all_others_are_as_before(starts):
    now, before = ([s.snapshot.trackers.position, s.snapshot.episodes.tick] for s in starts)
    clearance = starts[0].clearance
    inside = clearance.lifted(before[0], AROUND_BODY) > before[0][:, 2]
    assert 0 < inside.sum() < 0.05 * TRACKERS
    assert (clearance.lifted(now[0], AROUND_BODY) == now[0][:, 2]).all()
    for new, old in zip(now, before, strict=True):
        np.testing.assert_array_equal(new[~inside], old[~inside])
    assert (now[1][inside] != before[1][inside]).all()
    assert (starts[0].snapshot.episodes.number == 0).all()


def test_a_start_that_is_drawn_again_depends_on_its_seed_alone(starts):
    now, before = (each.snapshot.trackers.position for each in starts)
    moved = np.flatnonzero((now != before).any(axis=1))
    alone = simulation_with(None, SimConfig(), each_alone(1))
    own = simulation_with(None, SimConfig(), each_alone(TRACKERS))
    own.reseed_alone(np.arange(TRACKERS), 100 + np.arange(TRACKERS))
    own.reset()
    for tracker in moved[:1].tolist():
        alone.reseed(100 + tracker)
        alone.reset()
        expected = own.snapshot.trackers.position[tracker]
        np.testing.assert_array_equal(alone.snapshot.trackers.position[0], expected)


def test_no_free_start_is_told_in_one_line():
    simulation = simulation_with(slab(1e3), SimConfig(), each_alone(2))
    with pytest.raises(SpawnError, match="start: 100 starts were drawn, and all are inside"):
        simulation.reset()
    assert (simulation.snapshot.episodes.number == 0).all()


def test_in_a_world_that_goes_on_they_start_above_it():
    config = SimConfig(same_target=True)
    simulation = simulation_with(slab(60.0), config, together(2))
    simulation.reset()
    assert simulation.snapshot.trackers.position[:, 2] == pytest.approx(60.3)


def test_trackers_of_a_world_do_not_start_in_each_other():
    config, world_of = SimConfig(), together(3)
    assets, snapshot = assets_of(config, world_of), Snapshot.create(3)
    worlds = Worlds(config, assets, world_of)
    present = np.flatnonzero(assets.traffic.motion.sampled().table["present"][60] > 0.0)
    snapshot.targets.actor[:] = present[[0, 0, 1]]
    snapshot.episodes.tick[:] = 3000
    snapshot.episodes.start_offset[:, 2] = 200.0  # over everything
    trackers = np.arange(3)
    lifts = starts_in(assets, snapshot, worlds, shared_target=False).lifts(trackers)
    assert lifts == pytest.approx([0.0, 1.0, 0.0])
    assert not starts_in(assets, snapshot, worlds, shared_target=True).lifts(trackers).any()
