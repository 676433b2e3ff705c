"""A world without trackers, drawn at any time of its traffic and from any camera."""

import numpy as np

from eyas.engine.sim.assets import Assets
from eyas.engine.state.draw import DrawList, Picture, Views
from eyas.engine.state.motion import ActorState
from eyas.engine.targets.kind import Looks
from eyas.engine.targets.looks import LookSampler
from eyas.engine.traffic.lamps import shining
from eyas.lanes import interpreted

_shining = interpreted(shining)


class StillWorld:
    """One world without trackers: for galleries, benchmarks and tests of pictures.

    Args:
        assets: Map, traffic and renderer.
        seed: Seed of the actors' models and colours.
    """

    def __init__(self, assets: Assets, seed: int = 1) -> None:
        self.assets = assets
        model, colour = LookSampler(assets.traffic.motion.kind).sample(np.random.default_rng(seed))
        self._looks = Looks(model[None], colour[None])

    def actors(self, time: float) -> ActorState:
        """Return all actors at a time [s], one world."""
        actors = ActorState.create(1, self.assets.traffic.actors)
        self.assets.traffic.at(np.array([time]), actors)
        return actors

    def movers(self, time: float) -> DrawList:
        """Return the drawn parts of the actors at a time [s], one world."""
        movers = self.assets.rigs.draw_list(1)
        self.assets.rigs.pose(self.actors(time), self._looks, movers)
        motion = self.assets.traffic.motion
        if motion.lamps.size:
            lit = [_shining(motion, actor, time) for actor in range(len(motion.kind))]
            movers.lamps = np.array(lit, np.uint8)[None, self.assets.rigs.owner]
        signals = self.assets.signals
        return movers if signals is None else signals.added(movers, np.array([time]))

    def draw(self, views: Views, time: float, picture: Picture, samples: int = 1) -> None:
        """Draw views of the world at a time [s]; see
        `eyas.engine.render.renderer.Renderer.draw`.
        """
        self.assets.renderer.draw(views, self.movers(time), picture, samples)
