"""The target is a drone."""

from eyas.benchmark.protocols.envelope import Envelope
from eyas.benchmark.protocols.protocol import NEVER, Protocol
from eyas.engine.targets.habit import Behaviour
from eyas.engine.traffic.library import TEST_TRAFFIC

_HIGHEST = 200.0  # Above the ground below the drone [m]; targets cruise over towers, 60 m up

_WAYS = (Behaviour.CRUISE, Behaviour.ORBIT, Behaviour.ROAM, Behaviour.FLEE)

AIR = Protocol(
    "air",
    "60 s: a drone that flies over roofs, circles, or flees between houses and below trees",
    {
        "start": {"height": {"uniform": [4.0, 8.0]}},
        "done": {
            "total_steps": 30_000,
            "no_reward_steps": NEVER,
            "max_height": _HIGHEST + 5.0,  # By default 50 m, where a target that cruises leads on
        },
    },
    targets=("Quadrotor",),
    episodes=6,
    columns=("kept", "tsr", "losses", "found_again", "seen", "flawless"),
    rank="kept",
    groups={"way": lambda record: record.variant},
    variants={way.value: {"objects": {"behaviour": way.value}} for way in _WAYS},
    oracles={"actions": "velocity"},
    recordings=TEST_TRAFFIC,
    # Above the ground below the drone: its target flies 2 m above that, or over a tower.
    envelope=Envelope(lowest=3.0, highest=_HIGHEST),
)
