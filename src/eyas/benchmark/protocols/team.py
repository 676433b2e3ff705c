"""Several drones follow one target together, and one camera is blind for a while."""

from eyas.benchmark.episodes.first_fitting import with_visible_targets
from eyas.benchmark.flight.team import TeamScenario
from eyas.benchmark.protocols.protocol import NEVER, Protocol
from eyas.engine.traffic.library import TEST_TRAFFIC

_BESIDE = {"start": {"horizontal_bias": {"mirrored": [12.0, 25.0]}}}

PAIR = Protocol(
    "pair",
    "60 s: two drones, one target; the second starts with it out of view, one camera is covered "
    "for 5 to 15 s",
    {
        "traffic": {"demand": "keep_alive"},
        "done": {"total_steps": 30_000, "no_reward_steps": NEVER},
    },
    columns=("team_seen", "alone_seen", "handed_over", "handover_time", "tsr", "crashed"),
    rank="team_seen",
    variants={"drone-1": {}, "drone-2": _BESIDE},
    team=True,
    choose=with_visible_targets,
    recordings=TEST_TRAFFIC,
    scenario=TeamScenario,
)

TEAM = PAIR.like(
    "team",
    "60 s: as pair, with four drones, three of which start with the target out of view",
    variants={"drone-1": {}, "drone-2": _BESIDE, "drone-3": _BESIDE, "drone-4": _BESIDE},
)
