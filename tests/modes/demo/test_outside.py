"""A tracker outside, a window, and what their pictures and keys do."""

import asyncio
import importlib.util
import os
import threading
import time
from pathlib import Path

import pytest

from eyas.core.config import updated
from eyas.modes.demo.run import cockpit_of
from eyas.settings.config import EyasConfig

EXAMPLE = Path(__file__).parents[3] / "examples/demo_tracker.py"


def test_the_example_of_a_tracker_flies_to_the_red_car(served, viewer):
    spec = importlib.util.spec_from_file_location("demo_tracker", EXAMPLE)
    example = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(example)
    viewer.say("look", view="drone", overlay=True, width=320, height=180)
    viewer.say("do", what="parked_target")
    viewer.settled()
    hold = lambda: viewer.hold("left")  # noqa: E731
    viewer.until(lambda s: s["offset"] > 3, while_waiting=hold)
    viewer.settled()
    viewer.say("fly", policy="boxes")

    async def track():
        running = asyncio.create_task(example.main(served.socket))
        while not done.is_set():
            await asyncio.sleep(0.05)
        running.cancel()
        await asyncio.gather(running, return_exceptions=True)

    done = threading.Event()
    tracker = threading.Thread(target=lambda: asyncio.run(track()))
    tracker.start()
    try:
        viewer.until(lambda s: s["offset"] < 1.8 and s["flies"] == "boxes")
    finally:
        done.set()
        tracker.join()


@pytest.fixture
def window(monkeypatch):
    pygame = pytest.importorskip("pygame")
    monkeypatch.setitem(os.environ, "SDL_VIDEODRIVER", "dummy")
    from eyas.modes.demo.window import DemoWindow

    changes = {"world": {"map": "simpleway-grass"}}
    cockpit = cockpit_of(updated(EyasConfig(), changes))
    made = DemoWindow(pygame, cockpit)
    yield pygame, made, cockpit
    made.close()


def test_the_window_has_the_keys_and_the_picture(window):
    pygame, made, cockpit = window
    tracker = cockpit.flight.simulation.snapshot.trackers

    def fly(seconds):
        assert made.hear()
        cockpit.hold(made.held(), (0, 0.0), time.monotonic())
        cockpit.clock.skip(time.monotonic() - seconds)
        cockpit.advance(time.monotonic())

    before = tracker.position[0].copy()
    pygame.event.post(pygame.event.Event(pygame.KEYDOWN, key=pygame.K_UP))
    for _ in range(5):
        fly(0.1)
    made.show()
    assert abs(tracker.position[0] - before).max() > 1.0
    surface = pygame.display.get_surface()
    colours = {
        tuple(surface.get_at((x, y))[:3]) for x in range(0, 900, 60) for y in range(90, 480, 60)
    }
    assert len(colours) > 10
    pygame.event.post(pygame.event.Event(pygame.WINDOWFOCUSLOST))
    fly(0.1)
    assert made.held() == {}
    pygame.event.post(pygame.event.Event(pygame.KEYDOWN, key=pygame.K_p))
    fly(0.1)
    assert cockpit.clock.speed == 0.0
    pygame.event.post(pygame.event.Event(pygame.KEYDOWN, key=pygame.K_ESCAPE))
    assert not made.hear()
