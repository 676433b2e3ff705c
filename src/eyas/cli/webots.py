"""The program `webots` that `eyas webots-shim` installs: it starts `eyas serve`."""

import os
import sys
from collections.abc import Sequence
from pathlib import Path

__all__ = ["main"]


def main() -> None:
    """Serve the world that the arguments name, as `eyas serve` does; all else is ignored."""
    from eyas.cli.main import main as eyas

    sys.argv = [sys.argv[0], *_arguments(sys.argv[1:])]
    eyas()


def _arguments(words: Sequence[str]) -> list[str]:
    """Return the arguments of `eyas` for those of the program: ours, `--`, and those of Webots."""
    from eyas.cli.said import say
    from eyas.core.errors import EyasError
    from eyas.modes.serve.stand_in import serve_arguments

    cut = list(words).index("--")
    fixed, theirs = list(words[:cut]), words[cut + 1 :]
    if "--version" in theirs:
        return ["--version"]
    root = Path(fixed.pop(fixed.index("--root") + 1)) if "--root" in fixed else None
    if root is not None:
        fixed.remove("--root")
    try:
        told = serve_arguments(theirs, Path.cwd(), root)
    except EyasError as error:
        say(f"error: {error}")
        sys.exit(2)
    say(f"in the place of Webots, until 'kill {os.getpid()}': serve {' '.join(told)}")
    return ["serve", *told, *fixed]


if __name__ == "__main__":
    main()
