"""Settings files as no one should write them, made at random, for `test_wild.py` and as a script.

    python tests/dat/settings/wild.py --cases 1000000 [--first 0]

The script is run before a release. It tells how many cases there were, how many of them loaded, and
which took longest; it stops at the first that fails and names it.
"""

import argparse
import json
import random
import resource
import tempfile
import time
from collections.abc import Callable
from copy import deepcopy
from pathlib import Path
from typing import Any

from eyas.engine.core.errors import EyasError
from eyas.engine.settings.config import EyasConfig
from eyas.engine.settings.file import load_settings, save_settings

DATA = Path(__file__).parent / "data"

FILES = (
    json.loads(EyasConfig().model_dump_json()),
    *(json.loads(path.read_text()) for path in sorted(DATA.glob("*.json"))),
)

VALUES: tuple[Any, ...] = (
    None, True, False, 0, -1, 1, 2, 3, 0.5, -0.0, 1e-308, 1e308, -1e308, 10**30, -(10**30), 2**63,
    float("nan"), float("inf"), float("-inf"), "", " ", "0", "nan", "day", "night",
    "citystreet",
    "\u200b", "\x00", "\n", "\ud800", "\U0001f985", "é" * 50, "a" * 10_000, "../..", "/dev/null",
    "a:b", "a.b:c",
    [], [0], [1, 2], [3, 1], [None], [[0.5, 1.0]], ["x", "y"], list(range(1000)), {}, {"": 0},
    {"uniform": [0, 1]}, {"uniform": [1, 0]}, {"uniform": [0]}, {"uniform": [float("nan"), 1]},
    {"choice": []}, {"choice": [1, "x"]}, {"mirrored": [0.1, 0.2]}, {"unknown": 1},
    {"a": {"b": {"c": {"d": {}}}}},
)  # fmt: skip


def places(values: dict[str, Any], *inside: str) -> list[tuple[str, ...]]:
    """Return the keys of all values, groups too."""
    found = []
    for key, value in values.items():
        found.append((*inside, key))
        if isinstance(value, dict):
            found += places(value, *inside, key)
    return found


def changed(rng: random.Random, values: dict[str, Any]) -> None:
    """Change one value: replace, rename, remove, or add one."""
    *groups, key = rng.choice(places(values))
    for group in groups:
        values = values[group]
    what = rng.random()
    if what < 0.75:
        values[key] = deepcopy(rng.choice(VALUES))
    elif what < 0.85:
        values[misspelt(rng, key)] = values.pop(key)
    elif what < 0.95:
        del values[key]
    else:
        values[rng.choice(["x", "", "Sumo_Params", "world", "é", "__class__"])] = deepcopy(
            rng.choice(VALUES)
        )


def misspelt(rng: random.Random, key: str) -> str:
    """Return a key with a letter too many, too few, or in another case."""
    at = rng.randrange(len(key) + 1)
    return rng.choice([key[:at] + "x" + key[at:], key[:at] + key[at + 1 :], key.swapcase()])


TEXTS: tuple[Callable[[random.Random, bytes], bytes], ...] = (
    lambda rng, text: text[: rng.randrange(len(text))],
    lambda _, text: b"\xef\xbb\xbf" + text,
    lambda _, text: text.decode().encode("utf-16"),
    lambda rng, text: bytes(byte ^ (rng.random() < 0.001) for byte in text),
    lambda _, text: text.replace(b"{", b'{"seed": 1, "seed": 2, ', 1),
    lambda _, text: b"[" * 100_000,
    lambda _, text: b'{"a":' * 50_000,
    lambda _, text: b"",
    lambda _, text: b"[" + text + b"]",
    lambda _, text: b'{"seed": ' + b"9" * 10_000 + b"}",
    lambda rng, text: rng.randbytes(1000),
)
"""What may be done to the text of a file."""


def wild_text(number: int) -> bytes:
    """Return the content of case `number`."""
    rng = random.Random(number)
    values = json.loads(json.dumps(rng.choice(FILES)))
    for _ in range(rng.choice([1, 1, 1, 1, 1, 2, 8])):
        changed(rng, values)
    text = json.dumps(values).encode()
    return rng.choice(TEXTS)(rng, text) if rng.random() < 0.1 else text


def try_case(number: int, folder: Path) -> bool:
    """Load a case; return whether that succeeded.

    Raises:
        AssertionError: What it says is not one line, or the settings do not survive a round trip.
    """
    path, again = folder / "settings.json", folder / "again.json"
    path.write_bytes(wild_text(number))
    try:
        config = load_settings(path)
    except EyasError as error:
        line = str(error)
        assert line.strip(), number
        assert line.isprintable(), (number, line)
        assert len(line) < 5000, (number, line)
        return False
    save_settings(config, again)
    assert load_settings(again) == config, number
    return True


def main() -> None:
    """Try many cases."""
    parser = argparse.ArgumentParser(description=main.__doc__)
    parser.add_argument("--cases", type=int, default=1_000_000)
    parser.add_argument("--first", type=int, default=0)
    given = parser.parse_args()
    loaded, slowest = 0, (0.0, 0)
    with tempfile.TemporaryDirectory() as folder:
        for number in range(given.first, given.first + given.cases):
            start = time.perf_counter()
            try:
                loaded += try_case(number, Path(folder))
            except BaseException:
                print(f"case {number} failed:")
                raise
            slowest = max(slowest, (time.perf_counter() - start, number))
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    print(f"{given.cases:,} cases, of which {loaded:,} loaded; none failed")
    print(f"slowest: case {slowest[1]}, {slowest[0]:.2f} s; peak memory: {peak:.0f} MiB")


if __name__ == "__main__":
    main()
