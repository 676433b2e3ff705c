"""A drone with real flight dynamics follows a target in wind, behind a late link."""

import math

from eyas.benchmark.episodes.setting_out import AT_REST, AT_SPEED, at_rest_and_at_speed
from eyas.benchmark.protocols.protocol import NEVER, Protocol
from eyas.engine.traffic.library import TEST_TRAFFIC

FLOWN = Protocol(
    "flown",
    "20 s: a drone on a flight controller, 6 m/s of wind, 40 ms late, at rest and at speed",
    {
        "traffic": {"demand": "keep_alive"},
        "tracker": {
            "supervised": False,
            "flight": "mended",
            "drag_area": 0.05,
            "wind": {"speed": 6.0, "direction": {"uniform": [-math.pi, math.pi]}},
        },
        "control": {"action_latency_steps": 20.0},
        "start": {"velocity": "target"},
        "done": {"total_steps": 10_000, "no_reward_steps": NEVER},
    },
    columns=("tsr", "kept", "flawless", "worst_fifth", "losses", "search_time", "crashed"),
    choose=at_rest_and_at_speed,
    variants={AT_SPEED: {}, AT_REST: {"start": {"velocity": "rest"}}},
    groups={"start": lambda record: record.variant},
    tells_solvable=True,
    oracles={"actions": "velocity"},
    recordings=TEST_TRAFFIC,
)
