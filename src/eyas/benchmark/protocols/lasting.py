"""Episodes that last: is the target kept, found, and kept apart from others that look like it?"""

from eyas.benchmark.episodes.first_fitting import visible_and_independent, with_visible_targets
from eyas.benchmark.episodes.neighbours import with_neighbours
from eyas.benchmark.protocols.envelope import Envelope, Gimbal
from eyas.benchmark.protocols.protocol import NEVER, Protocol
from eyas.engine.traffic.library import TEST_TRAFFIC

LONG = Protocol(
    "long",
    "60 s: when is the target lost, and is it found again?",
    {
        "traffic": {"demand": "keep_alive"},
        "done": {"total_steps": 30_000, "no_reward_steps": NEVER},
    },
    columns=("kept", "tsr", "flawless", "worst_fifth", "losses", "search_time", "crashed"),
    tells_solvable=True,
    choose=with_visible_targets,
    recordings=TEST_TRAFFIC,
)

LONG_TEN = LONG.like(
    "long-10",
    "589 s: losses in ten minutes, on six maps in four weathers by day and night",
    {"done": {"total_steps": 294_400}, "control": {"frequency": 31.25}},
    episodes=1,
    maps=("citystreet", "downtown", "village", "lake", "desert", "farmland"),
    weathers=("day", "night", "foggy", "snow"),
    columns=("losses_per_hour", "kept", "tsr", "flawless", "losses", "found_again", "crashed"),
    rank="kept",
    choose=visible_and_independent,
    oracles={"action_repeat": 4},
)
"""As long as fits into the recordings for tests, which last 600 s: there are no longer ones.
Flights are measured every 32 ms, as often as policies act: with 8 ms they take twice as long."""

GIMBAL = LONG.like(
    "gimbal",
    "60 s: as long, with a camera that turns; a target counts within 40 m of it",
    envelope=Envelope(gimbal=Gimbal()),
    farthest=40.0,
)
"""Looking is not tracking: from the height of the start, a drone that stays behind has lost after
40 m what it could point its camera at for 700 m more."""

SEARCH = Protocol(
    "search",
    "20 s: the target starts out of view, 12 to 25 m beside the middle",
    {
        "traffic": {"demand": "keep_alive"},
        "start": {"horizontal_bias": {"mirrored": [12.0, 25.0]}},
        "done": {"total_steps": 10_000, "no_reward_steps": NEVER},
    },
    columns=("to_find", "tsr", "worst_fifth", "kept", "losses", "search_time", "crashed"),
    recordings=TEST_TRAFFIC,
)

DISTRACTOR = Protocol(
    "distractor",
    "20 s: all vehicles have the target's model and colour, and one is beside it",
    {
        "traffic": {"demand": "keep_alive"},
        "done": {"total_steps": 10_000, "no_reward_steps": NEVER},
    },
    columns=("kept", "tsr", "flawless", "worst_fifth", "seen", "losses", "crashed"),
    alike=True,
    tells_solvable=True,
    choose=with_neighbours,
    recordings=TEST_TRAFFIC,
)
