"""The target is out of sight for seconds, and must be found again."""

from eyas.benchmark.episodes.target_losses import COVERED, with_losses
from eyas.benchmark.flight.recovery import RecoveryScenario
from eyas.benchmark.protocols.protocol import NEVER, Protocol
from eyas.engine.traffic.library import TEST_TRAFFIC

_LENGTH = {"total_steps": 45_000, "no_reward_steps": NEVER}

RECOVER = Protocol(
    "recover",
    "90 s: the target is hidden one to three times, for 4 to 12 s each, by what stands there",
    {"traffic": {"demand": "keep_alive", "drivers": "hiding"}, "done": _LENGTH},
    maps=("village",),
    columns=("recovered", "recovery_time", "followed_wrong", "nt2f", "tsr", "crashed"),
    rank="recovered",
    choose=with_losses,
    scenario=RecoveryScenario,
    recordings=TEST_TRAFFIC[:1],
)

RECOVER_CAMERA = Protocol(
    "recover-camera",
    "90 s: the camera is covered twice, for 2, 5, 10 or 15 s",
    {"traffic": {"demand": "keep_alive"}, "done": _LENGTH},
    episodes=3,
    columns=tuple(
        "recovered recovered_2s recovered_5s recovered_10s recovered_15s recovery_time "
        "followed_wrong nt2f crashed".split()
    ),
    rank="recovered",
    choose=with_losses,
    scenario=RecoveryScenario,
    variants={name: {} for name in COVERED},
    recordings=TEST_TRAFFIC,
)
