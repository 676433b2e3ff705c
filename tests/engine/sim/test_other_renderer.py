"""Another renderer in the place of Eyas' own, and when that packs what it draws."""

import dataclasses

import numpy as np

from eyas.engine.render.renderer import CpuRenderer
from eyas.engine.sim.simulation import Simulation
from eyas.engine.sim.worlds import each_alone
from eyas.engine.state.draw import DrawStage, Picture, Renderer
from eyas.engine.trackers.drone import DRONE


class Distances:
    """Shows each view as the distance of its nearest actor, in all pixels."""

    def part_reach(self):
        return np.full(10_000, 5.0)

    def influence(self, reach):
        return reach + 40.0

    def draw(self, views, draw_list, picture, samples=1, until=DrawStage.SHADING):
        for view, (world, eye) in enumerate(zip(views.world, views.position, strict=True)):
            places = draw_list.pose[world][draw_list.part[world] >= 0][:, :, 3]
            picture.depth[view] = np.linalg.norm(places - eye, axis=1).min()


def test_a_simulation_draws_with_any_renderer(config, assets):
    renderer: Renderer = Distances()
    simulation = Simulation(
        config, dataclasses.replace(assets, renderer=renderer), DRONE, each_alone(2)
    )
    simulation.reset()
    picture = Picture.create(2, 6, 8, rgb=False, depth=True)
    simulation.draw(np.arange(2, dtype=np.int32), picture)
    targets = simulation.snapshot.targets.centre - simulation.snapshot.cameras.position
    away = np.linalg.norm(targets, axis=1)
    assert (picture.depth.max(axis=(1, 2)) <= away + 5.0).all()
    assert (picture.depth > 0.0).all()


def test_nothing_is_packed_for_drawing_before_the_first_picture(config, assets):
    """Evaluations of oracles and environments without pictures never wait for it."""
    asked = []

    def pack():
        asked.append(True)
        return assets.renderer.packed

    trackers, pictures = np.arange(2, dtype=np.int32), []
    for renderer in (CpuRenderer(pack), assets.renderer):
        lazy = dataclasses.replace(assets, renderer=renderer)
        simulation = Simulation(config, lazy, DRONE, each_alone(2))
        simulation.reset()
        simulation.advance(np.zeros((2, 4)), 10)
        simulation.packets()
        assert not asked or pictures
        pictures.append(Picture.create(2, 6, 8, depth=True, object_id=True))
        for _ in range(2):
            simulation.draw(trackers, pictures[-1])
    assert asked == [True]
    for name in ("rgb", "depth", "object_id"):
        assert np.array_equal(*(getattr(picture, name) for picture in pictures)), name
