"""The program `webots` that `eyas webots-shim` installs: it starts `eyas serve`."""

import os
import re
import sys
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path


def main() -> None:
    """Serve the world that the arguments name, as `eyas serve` does; all else is ignored."""
    _listen_early(sys.argv[1:])
    from eyas.engine.core.doors import first_brought

    sys.argv = [sys.argv[0], *_arguments(sys.argv[1:])]
    first_brought("eyas.command_line")()


def _listen_early(words: Sequence[str]) -> None:
    """Listen where the settings of the nearest folder say, before anything heavy is imported: the
    program that starts this one may announce its agents at any time.

    What is wrong in the settings, or here, is found and named later.
    """
    from eyas.dat.wire.announcements import listen_early  # light

    worlds = [word for word in words if word.endswith(".wbt")]
    fixed = words[words.index("--root") + 1 :][:1] if "--root" in words else worlds[-1:]
    starts = [Path(os.path.abspath(folder)) for folder in (*fixed, "")]
    roots = (root for start in starts for root in (start, *start.parents))
    files = (root / "Webots_Simulation/traffic_project/config/env_config.json" for root in roots)
    with suppress(OSError):
        file = next((file for file in files if file.is_file()), Path(os.devnull))
        text = file.read_text(encoding="utf-8", errors="replace")
        port = re.search(r'"Config_Agen_Num_Port"\s*:\s*([1-9]\d{0,4})\b', text)
        address = re.search(r'"Socket_Ip"\s*:\s*"([^"]*)"', text)
        if port and int(port[1]) < 65536:
            listen_early(address[1] if address else "127.0.0.1", int(port[1]))


def _arguments(words: Sequence[str]) -> list[str]:
    """Return the arguments of `eyas` for those of the program: ours, `--`, and those of Webots."""
    from eyas.dat.serve.stand_in import serve_arguments
    from eyas.engine.core.errors import EyasError
    from eyas.engine.terminal.stderr import say

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
