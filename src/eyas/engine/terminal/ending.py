"""How commands end: what they have made, and what to type next."""

import shlex
from collections.abc import Sequence
from pathlib import Path


def print_ending(made: str, *steps: tuple[str, Sequence[str | Path]]) -> None:
    """Print a line on what was made, and one for each next step.

        60 frames in runs/first
        to see it: eyas open runs/first

    Args:
        made: What was made, and where.
        steps: What for, and the words of the command; words in capitals are for the user to choose.
    """
    print(made)
    for purpose, command in steps:
        print(f"to {purpose}: {shlex.join(map(str, command))}")
