"""The target is out of sight for seconds, and must be found again."""

from eyas.benchmark.episodes.loss_sites import at_sites, kind_of
from eyas.benchmark.episodes.target_losses import COVERED, with_losses
from eyas.benchmark.flight.recovery import RecoveryScenario, WideRecoveryScenario
from eyas.benchmark.protocols.protocol import NEVER, Protocol
from eyas.engine.traffic.library import TEST_TRAFFIC
from eyas.engine.world.maps.recipe import TEST_TOWNS

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

_COVERED = "eyas.maps.covered"

RECOVER_WIDE = RECOVER.like(
    "recover-wide",
    "60 s: roofs of 10 to 150 m over straight roads, bends and junctions, in towns and on maps",
    {"traffic": {"drivers": "normal"}, "done": {"total_steps": 30_000}},
    episodes=6,
    maps=(
        f"{_COVERED}:CITYSTREET:{TEST_TOWNS[0]}",
        f"{_COVERED}:DOWNTOWN:{TEST_TOWNS[0]}",
        f"{_COVERED}:DOWNTOWN:{TEST_TOWNS[1]}",
        f"{_COVERED}:VILLAGE:{TEST_TOWNS[1]}",
        f"{_COVERED}:LAKE",
        f"{_COVERED}:FARMLAND",
    ),
    elsewhere=True,
    choose=at_sites,
    scenario=WideRecoveryScenario,
    groups={
        "way": lambda record: kind_of(record.variant)[0],
        "hidden": lambda record: kind_of(record.variant)[1],
    },
)
