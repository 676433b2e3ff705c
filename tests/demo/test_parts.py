"""Parts of the demo by themselves: clock, sizes of pictures, duels, boxes and tokens."""

import math
from types import SimpleNamespace

import numpy as np
import pytest
from websockets.datastructures import Headers
from websockets.http11 import Request

from eyas.demo.controllers import READY, SECONDS, BoxController, Duel
from eyas.demo.server import Gate
from eyas.demo.session import FRAME, AdaptiveSize, Clock
from eyas.engine.core.clock import PHYSICS_RATE


def test_a_machine_that_stood_still_flies_slower_and_not_farther():
    clock = Clock(0.0)
    assert clock.steps(0.1) == 50
    assert clock.steps(10.0) == 50
    clock.speed = 0.5
    assert clock.steps(10.05) == 12


def test_pictures_that_were_too_large_grow_later_each_time():
    size = AdaptiveSize()
    size.fit(1280, 720)

    def frames_to_grow():
        before, count = size.now, 0
        while size.now <= before:
            size.spent(0.05 * FRAME)
            count += 1
        return count

    def shrink():
        before = size.now
        while size.now >= before:
            size.spent(3.0 * FRAME)

    first = frames_to_grow()
    shrink()
    assert frames_to_grow() > 1.5 * first


def test_both_flights_of_a_duel_last_a_minute():
    duel, minute = Duel("eyas", now=0.0), SECONDS * PHYSICS_RATE
    assert duel.waits(READY - 0.1)
    assert not duel.waits(READY + 0.1)
    assert not duel.count(0.5, minute - 1, READY)
    assert duel.count(0.5, 1, READY)
    assert duel.stage == "policy"
    assert duel.count(0.25, minute, READY)
    assert duel.stage == "over"
    assert duel.state(READY)["scores"] == {"you": 50.0, "policy": 25.0}


def test_it_flies_towards_the_side_on_which_the_box_is():
    cameras = SimpleNamespace(
        position=np.array([[0.0, 0.0, 20.0]]), field_of_view=np.array([math.pi / 2])
    )
    targets = SimpleNamespace(position=np.zeros((1, 3)))
    flight = SimpleNamespace(
        simulation=SimpleNamespace(snapshot=SimpleNamespace(cameras=cameras, targets=targets)),
        config=SimpleNamespace(camera=SimpleNamespace(width=640, height=360)),
    )
    controller = BoxController(flight)
    controller.see((0.1, 0.0, 0.3, 0.2), (640, 360))  # upper left: ahead and to the left
    (ahead, left, up, turn), _ = controller.decide()[0][0], None
    assert (ahead > 0.0, left > 0.0, up, turn) == (True, True, 0.0, 0.0)
    controller.see(None, (640, 360))
    assert not controller.decide()[0].any()


@pytest.mark.parametrize(("query", "refused"), [("", True), ("?token=no", True), (None, False)])
def test_others_than_loopback_need_the_token(query, refused):
    gate = Gate("0.0.0.0")
    path = f"/map.json?token={gate.token}" if query is None else f"/map.json{query}"
    request = Request(path, Headers({"Host": "drone.local:8720"}))
    assert (gate.refusal(request, private=True) is not None) == refused
    assert gate.refusal(request, private=False) is None
