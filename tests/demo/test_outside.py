"""A tracker outside Eyas that flies in the demo."""

import asyncio
import importlib.util
import threading
from pathlib import Path

import pytest

pytestmark = pytest.mark.slow  # what its tests share takes long to make

EXAMPLE = Path(__file__).parents[2] / "examples/demo_tracker.py"


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
