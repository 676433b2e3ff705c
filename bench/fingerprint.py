"""Hash the output of Eyas, to show whether a change of the code changed any byte of it.

    python bench/fingerprint.py before.json          # on the commit before
    python bench/fingerprint.py after.json before.json

It covers pictures in all weathers, rewards and packets under random actions, other vehicle types,
and complete recordings of `eyas video`. The second call lists the hashes that differ.
"""

import hashlib
import json
import sys
import tempfile
from pathlib import Path

import gymnasium
import numpy as np

import eyas  # noqa: F401  # registers the environments
from eyas.engine.settings.config import EyasConfig
from eyas.engine.video.run import run as record

WEATHERS = ("day", "foggy", "night", "snow")
SHORT = {"channels": 3, "total_time": 4.0, "fps": 12.5}
RECORDINGS = {
    "following": {"video": SHORT | {"flight": "exact"}},
    "random": {"video": SHORT | {"flight": "random", "target_direction": True}, "seed": 3},
    "overlay": {
        "video": SHORT | {"flight": "exact", "overlay": True},
        "reward": {"type": "distance"},
    },
}
FLEETS = ("bus", "truck", "trailer", "motorcycle")


def flown(name: str, steps: int, **kwargs: object) -> dict[str, str]:
    """Return hashes of pictures and numbers of an environment under random actions."""
    env = gymnasium.make(name, disable_env_checker=True, **kwargs).unwrapped
    rng = np.random.default_rng(7)
    pictures, numbers = hashlib.sha256(), hashlib.sha256()
    observation, info = env.reset(seed=5)
    for step in range(steps):
        pictures.update(observation.tobytes())
        rendered = env.render()
        if rendered is not None:
            pictures.update(rendered.tobytes())
        numbers.update(
            repr(
                {
                    key: np.asarray(info[key]).tolist()
                    for key in sorted(key for key in info if not key.startswith("reward/"))
                }
            ).encode()
        )
        observation, reward, ended, cut, info = env.step(int(rng.integers(7)))
        numbers.update(repr((float(reward), ended, cut)).encode())
        if ended or cut or step % 25 == 24:
            observation, info = env.reset()
    return {"pictures": pictures.hexdigest()[:16], "numbers": numbers.hexdigest()[:16]}


def recorded(settings: dict[str, object]) -> dict[str, str]:
    """Return hashes of the files of a recording, by kind."""
    kinds: dict[str, hashlib._Hash] = {}
    with tempfile.TemporaryDirectory() as folder:
        record(EyasConfig.model_validate(settings), Path(folder) / "run", quiet=True)
        for path in sorted(Path(folder).rglob("*.*")):
            if path.parent.name.startswith("episode"):
                kinds.setdefault(path.suffix, hashlib.sha256()).update(path.read_bytes())
    return {kind: digest.hexdigest()[:16] for kind, digest in kinds.items()}


def fingerprint() -> dict[str, str]:
    """Return all hashes by name."""
    parts: dict[str, dict[str, str]] = {}
    for weather in WEATHERS:
        name = f"eyas/citystreet-{weather}-v0"
        parts[f"env {weather}"] = flown(name, 60)
        sharp = {"camera": {"samples": 4}, "light": {"background": {"uniform": [-0.3, 0.3]}}}
        render = {"render_mode": "rgb_array", "overlay": True}
        parts[f"env {weather}, 4 samples, overlay"] = flown(name, 8, config=sharp, **render)
    for fleet in FLEETS:
        traffic = {"vehicle_type": fleet, "max_vehicles": 12}
        parts[f"env {fleet}"] = flown("eyas/citystreet-night-v0", 20, config={"traffic": traffic})
    for name, settings in RECORDINGS.items():
        parts[f"video {name}"] = recorded(settings)
    return {
        f"{part}: {kind}": text for part, hashes in parts.items() for kind, text in hashes.items()
    }


def main() -> None:
    """Write the hashes; compare them with earlier ones."""
    found = fingerprint()
    Path(sys.argv[1]).write_text(json.dumps(found, indent=1))
    if len(sys.argv) > 2:
        known = json.loads(Path(sys.argv[2]).read_text())
        other = [key for key in known.keys() | found.keys() if known.get(key) != found.get(key)]
        print("\n".join(sorted(other)) or f"all {len(found)} hashes are the same")
        sys.exit(bool(other))


if __name__ == "__main__":
    main()
