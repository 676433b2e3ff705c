"""The door of this house, see `eyas.engine.core.doors`."""

from eyas.engine.core.doors import House

HOUSE = House(
    results=True,
    brings={
        "eyas.policy_opener": {"open_policy": "eyas.benchmark.policies.table:open_policy"},
        "eyas.commands": {
            "evaluate": "eyas.benchmark.commands:evaluate",
            "compare": "eyas.benchmark.commands:compare",
            "leaderboard": "eyas.benchmark.commands:leaderboard",
            "reproduce": "eyas.benchmark.commands:reproduce",
            "policies": "eyas.benchmark.commands:policies",
        },
    },
)
