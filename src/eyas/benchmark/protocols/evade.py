"""The target's driver wants to be lost."""

from eyas.benchmark.flight.evasion import EvasionScenario, evading
from eyas.benchmark.protocols.protocol import NEVER, Protocol
from eyas.engine.traffic.library import EVADING_MIX, TEST_TRAFFIC

EVADE = Protocol(
    "evade",
    "60 s: the target's driver stops, turns round, dashes, weaves behind buses and hides",
    {
        "traffic": {
            "demand": "keep_alive",
            "drivers": "evading",
            "vehicle_type": EVADING_MIX.model_dump(exclude_defaults=True),
        },
        "done": {"total_steps": 30_000, "no_reward_steps": NEVER},
    },
    columns=("kept", "held", "held_stop", "held_turn", "held_dash", "held_hiding", "losses", "tsr"),
    rank="kept",
    choose=evading,
    scenario=EvasionScenario,
    recordings=TEST_TRAFFIC[:1],
)
