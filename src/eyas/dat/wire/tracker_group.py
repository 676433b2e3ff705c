"""The trackers of all clients, in one world, in lock-step."""

import logging
from collections.abc import Sequence
from concurrent.futures import Future, ThreadPoolExecutor, wait
from typing import NamedTuple

import numpy as np

from eyas.dat.wire.exchange import Action, packet_line
from eyas.engine.core.codecs.jpeg import jpeg_bytes
from eyas.engine.core.errors import SpawnError
from eyas.engine.sim.serving import Orders
from eyas.engine.sim.simulation import Simulation
from eyas.engine.state.draw import Picture
from eyas.engine.targets.catalogue import MODELS
from eyas.engine.task.packet_rows import SENSOR_COLUMNS
from eyas.engine.task.packets import BASIC_COLUMNS
from eyas.lanes import thread_count

_LOG = logging.getLogger("eyas")


class Answer(NamedTuple):
    """What a client gets for an action."""

    state: bytes  # The basic packet
    reward: bytes  # The reward packet
    radar: bytes | None  # The radar packet; None without a lidar
    picture: Future[bytes]  # JPEG; made in another thread while the client reads the packets


class TrackerGroup:
    """N trackers that act at once and share a world, whose time goes on from episode to episode.

    Attributes:
        sim: The simulation.

    Args:
        sim: Simulation of N trackers together.
        physics_steps: How many steps of 2 ms an action lasts.
    """

    def __init__(self, sim: Simulation, physics_steps: int) -> None:
        camera = sim.config.camera
        self.sim = sim
        self._steps = physics_steps
        self._picture = Picture.create(sim.count, camera.height, camera.width)
        self._trackers = np.arange(sim.count, dtype=np.int32)
        workers = max(2, min(sim.count, thread_count()))
        self._threads = ThreadPoolExecutor(workers, "eyas-pictures")
        self._drawn: list[Future[bytes]] = []
        self._begun = False
        self._resets = np.zeros(sim.count, np.bool_)  # who gets a new episode with the answer
        self._unasked = np.zeros(sim.count, np.bool_)  # who gets one without having asked

    def close(self) -> None:
        """Wait for the last pictures."""
        self._threads.shutdown(wait=True, cancel_futures=True)

    def orders(self, actions: Sequence[Action]) -> Orders:
        """Return the orders of one action of each tracker, shape (N,), that `answers` answers.

        Those that reset begin a new episode at the end of the others' action. Whoever did not ask
        for the new episode that it gets, because the traffic begins anew, is told that the last one
        has ended.

        Raises:
            SpawnError: There are fewer targets than trackers.
        """
        wait(self._drawn)  # an answer may have been dropped before its picture was done
        sim, steps = self.sim, self._steps
        self._resets = np.array([action.reset for action in actions])
        self._unasked = np.zeros(sim.count, np.bool_)
        everyone = bool(self._resets.all())
        if not self._begun:  # all begin, whatever they ask for
            sim.reset()
            self._begun, self._resets, steps = True, self._unasked, 0
        elif sim.steps_left < (sim.config.done.total_steps if everyone else steps):
            _LOG.info("the traffic has reached its end, and begins anew for all trackers")
            self._renew()
            steps = 0
        return Orders(np.array([a.command for a in actions]), 0 if everyone else steps)

    def answers(self) -> list[Answer]:
        """Return the answers, shape (N,), after the orders have been carried out.

        Raises:
            SpawnError: There are fewer targets than trackers.
        """
        if self._resets.any():
            try:
                self.sim.reset(self._resets)
            except SpawnError as error:
                _LOG.warning("%s; so the traffic begins anew for all trackers", error)
                self._renew()
        basic, reward = self.sim.packets()
        seen = self.sim.view
        # What is sensed may be late; time, reward, end and the reward packet are not.
        basic[:, SENSOR_COLUMNS] = seen.packets()[0][:, SENSOR_COLUMNS]
        basic[self._unasked, BASIC_COLUMNS["done"]] = 1.0
        self._drawn = self._draw()
        models = self.sim.snapshot.targets.model.tolist()
        radar = None
        if seen.lidar is not None:
            radar = [packet_line(row) for row in seen.lidar.packets(seen.state.late)]
        return [
            Answer(
                packet_line(basic[n]),
                packet_line(reward[n], MODELS[models[n]].typename),
                None if radar is None else radar[n],
                picture,
            )
            for n, picture in enumerate(self._drawn)
        ]

    def _renew(self) -> None:
        """Begin the traffic and all episodes anew, also of those who did not ask for it."""
        self._unasked, self._resets = ~self._resets, np.zeros(self.sim.count, np.bool_)
        self.sim.rewind()
        self.sim.reset()

    def _draw(self) -> list[Future[bytes]]:
        """Begin to draw; return the pictures to come."""
        pictures: list[Future[bytes]] = [Future() for _ in range(self.sim.count)]
        self._threads.submit(self._draw_all, pictures)
        return pictures

    def _draw_all(self, pictures: list[Future[bytes]]) -> None:
        try:
            self.sim.view.draw(self._trackers, self._picture)
        except BaseException as error:
            for picture in pictures:
                picture.set_exception(error)
            raise
        for tracker, picture in enumerate(pictures):
            self._threads.submit(self._encode, tracker, picture)

    def _encode(self, tracker: int, picture: Future[bytes]) -> None:
        assert self._picture.rgb is not None  # created above
        try:
            picture.set_result(jpeg_bytes(self._picture.rgb[tracker]))
        except BaseException as error:
            picture.set_exception(error)
            raise
