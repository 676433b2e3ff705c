"""The target is out of sight for seconds, and must be found again."""

import math

from eyas.benchmark.episodes.loss_sites import at_sites, kind_of
from eyas.benchmark.episodes.target_losses import COVERED, with_losses
from eyas.benchmark.flight.recovery import RecoveryScenario, WideRecoveryScenario
from eyas.benchmark.protocols.protocol import NEVER, Protocol
from eyas.engine.core.rng import TEST_SEEDS
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

_TOWNS = {
    "DOWNTOWN": (101, 106, 111, 116, 121, 126, 131, 136, 141, 146),
    "VILLAGE": (102, 107, 112, 117, 122, 127, 132, 137, 142, 147),
    "FARMLAND": (103, 108, 113, 118, 123, 128, 133, 138, 143, 148),
    "CITYSTREET": (104, 109, 114, 119, 124, 129, 134, 139, 144, 149),
    "LAKE": (105, 110, 115, 120, 125, 130, 135, 140, 145, 150),
}
"""Seeds of its towns by their kind, counted from `TEST_SEEDS`, as `tools/draw_towns.py` draws them:
50 of them, so that they are seeds of a few bytes each, and no data. SUMO makes their traffic."""

_DRAWN = tuple(
    f"eyas.maps.covered:{kind}:{TEST_SEEDS + seed}"
    for kind, seeds in _TOWNS.items()
    for seed in seeds
)

RECOVER_WIDE = RECOVER.like(
    "recover-wide",
    "60 s: roofs of 10 to 150 m over straight roads, bends and junctions, in 50 generated towns",
    {"done": {"total_steps": 30_000}, "control": {"frequency": 31.25}},
    directions=(0.0, math.pi),
    episodes=1,
    maps=_DRAWN,
    drawn=_DRAWN,
    elsewhere=True,
    choose=at_sites,
    scenario=WideRecoveryScenario,
    oracles={"action_repeat": 4},
    groups={
        "way": lambda record: kind_of(record.variant)[0],
        "hidden": lambda record: kind_of(record.variant)[1],
    },
)
"""Flights are measured every 32 ms, as often as policies act: with 8 ms they take four times as
long, most of it for the many towns."""
