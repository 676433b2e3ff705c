"""The target is an agent: fixed drivers who want to be lost."""

from eyas.benchmark.protocols.protocol import NEVER, Protocol
from eyas.engine.behaviours.evader import EvaderDriver
from eyas.engine.traffic.library import TEST_TRAFFIC

_DRIVERS = tuple(driver for driver in EvaderDriver if driver is not EvaderDriver.AGENT)

PURSUIT = Protocol(
    "pursuit",
    "60 s: the target is an agent, one of several fixed drivers",
    {
        "traffic": {"demand": "keep_alive"},
        "start": {"vehicles": ["passenger"]},
        "done": {"total_steps": 30_000, "no_reward_steps": NEVER},
    },
    episodes=8,
    columns=("kept", "elo", "tsr", "losses", "found_again", "seen"),
    rank="kept",
    groups={"driver": lambda record: record.variant},
    variants={driver.value: {"evader": {"driver": driver.value}} for driver in _DRIVERS},
    ratings={"cruise": 1000.0, "abrupt": 1000.0, "hide": 1000.0},
    recordings=TEST_TRAFFIC,
)
