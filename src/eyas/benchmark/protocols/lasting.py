"""Episodes that last: is the target kept, found, and kept apart from others that look like it?"""

from eyas.benchmark.episodes.neighbours import with_neighbours
from eyas.benchmark.protocols.protocol import NEVER, Protocol

LONG = Protocol(
    "long",
    "60 s: when is the target lost, and is it found again?",
    {
        "traffic": {"demand": "keep_alive"},
        "done": {"total_steps": 30_000, "no_reward_steps": NEVER},
    },
    columns=("kept", "tsr", "flawless", "worst_fifth", "losses", "search_time", "crashed"),
    tells_solvable=True,
)

SEARCH = Protocol(
    "search",
    "20 s: the target starts out of view, 12 to 25 m beside the middle",
    {
        "traffic": {"demand": "keep_alive"},
        "start": {"horizontal_bias": {"mirrored": [12.0, 25.0]}},
        "done": {"total_steps": 10_000, "no_reward_steps": NEVER},
    },
    columns=("to_find", "tsr", "worst_fifth", "kept", "losses", "search_time", "crashed"),
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
)
