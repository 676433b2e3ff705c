r"""Compare networks that learned with clean cameras and with varied ones, in what neither has seen.

    python bench/camera_training.py settings runs/camera
    cd runs/camera
    for seed in 0 1; do for kind in clean varied; do
        eyas train --config $kind.json --seed $seed --out $kind-$seed
        eyas evaluate --policy $kind-$seed/policy.onnx --protocol corrupted --episodes 1 \
            --out corrupted-$kind-$seed
        eyas evaluate --policy $kind-$seed/policy.onnx --protocol standard --episodes 2 \
            --weather day --weather night --weather foggy --weather rain --weather snow \
            --weather dusk --weather dust --weather autumn --weather overcast \
            --out weathers-$kind-$seed
    done; done
    python ../../bench/camera_training.py compare .

It prints a table: TSR over all seeds of training, with 95 % intervals of a bootstrap over starts.
"""

import argparse
import json
from collections.abc import Collection, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from eyas.engine.settings.file import preset_file

KINDS = ("clean", "varied")
DECISIONS = 245_760
SEEN = ("read-noise", "shot-noise", "motion-blur", "fog", "overexposure", "underexposure")
"""Faults of the kinds that the varied cameras have, mostly weaker."""
UNSEEN = (
    "hot-pixels",
    "defocus",
    "drops",
    "vibration",
    "snow",
    "dirt",
    "rolling-shutter",
    "lost-slices",
    "compression",
)
WEATHERS, FURTHER = (
    ("day", "night", "foggy", "rain"),
    ("snow", "dusk", "dust", "autumn", "overcast"),
)
GROUPS: Mapping[str, tuple[str, Collection[str]]] = {
    "a good sensor, no fault": ("corrupted", ("clean",)),
    "six faults of kinds that the varied have seen": ("corrupted", SEEN),
    "nine faults that neither has seen": ("corrupted", UNSEEN),
    "all fifteen": ("corrupted", (*SEEN, *UNSEEN)),
    "weathers of the training": ("weathers", WEATHERS),
    "five weathers that neither has seen": ("weathers", FURTHER),
}

Flights = dict[tuple[int, int], list[float]]
"""TSR by seed of training and by start."""


def camera(weather: str) -> dict[str, Any]:
    """Return cameras that differ in noise, exposure and blur."""
    dim = weather == "night"
    uniform = {
        "f_number": (2.0, 2.8) if dim else (2.8, 11.0),
        "pixel_pitch": (1.55, 3.45),
        "read_noise": (0.0, 3.0) if dim else (0.0, 60.0),
    }
    return {
        "imager": {name: {"uniform": limits} for name, limits in uniform.items()},
        "exposure": {
            "time": (0.000125, 0.03),
            "iso": (100, 6400),
            "compensation": {"uniform": (-1.0, 1.0)},
        },
        "shutter": {"blur": True, "most_samples": 3},
    }


def write_settings(folder: Path) -> None:
    """Write the settings of both kinds: the same weathers, and half of the varied with cameras."""
    settings = json.loads(preset_file("fast").read_text())
    settings["train"] = {
        "environments": 64,
        "ppo": {"minibatches": 8},
        "evaluation": {"every": 0},
        "stages": [{"total_timesteps": DECISIONS}],
    }
    clean = [{"weight": 1, "settings": {"world": {"weather": name}}} for name in WEATHERS]
    varied = [
        {"weight": 1, "settings": {"world": {"weather": name}, "camera": camera(name)}}
        for name in WEATHERS
    ]
    folder.mkdir(parents=True, exist_ok=True)
    for kind, mixture in zip(KINDS, (clean, clean + varied), strict=True):
        settings["env"]["mixture"] = mixture
        (folder / f"{kind}.json").write_text(json.dumps(settings, indent=1))


def flights(folder: Path, protocol: str, kind: str, chosen: Collection[str]) -> Flights:
    """Return the flights of a kind behind some faults, or in some weathers."""
    found: Flights = {}
    for file in sorted(folder.glob(f"{protocol}-{kind}-*/episodes.jsonl")):
        seed = int(file.parent.name.rpartition("-")[2])
        for line in file.read_text().splitlines():
            flown = json.loads(line)
            fault = flown["variant"].rpartition("-")[0] or "clean"
            if (fault if protocol == "corrupted" else flown["weather"]) in chosen:
                found.setdefault((seed, flown["seed"]), []).append(flown["tsr"])
    return found


def cell(means: Any, draws: Any) -> str:  # noqa: ANN401  # arrays: of each start, and drawn starts
    """Return the mean over starts, and its interval."""
    low, high = np.percentile(means[draws].mean(axis=1), (2.5, 97.5))
    return f"{means.mean():.3f} [{low:.3f}, {high:.3f}]"


def compare(folder: Path) -> None:
    """Print the table."""
    print("| TSR | flights each | clean | varied | varied less clean | each seed |")
    print("|---|---|---|---|---|---|")
    singly = {name: ("corrupted", (name,)) for name in (*SEEN, *UNSEEN)}
    singly |= {f"{name}, weather": ("weathers", (name,)) for name in (*WEATHERS, *FURTHER)}
    for label, (protocol, chosen) in {**GROUPS, **singly}.items():
        both = [flights(folder, protocol, kind, chosen) for kind in KINDS]
        seeds = sorted({seed for seed, _ in both[0]} & {seed for seed, _ in both[1]})
        starts = sorted({start for _, start in both[0]})
        clean, varied = (
            np.array([[np.mean(one[seed, start]) for start in starts] for seed in seeds])
            for one in both
        )
        draws = np.random.default_rng(0).integers(len(starts), size=(10_000, len(starts)))
        number = sum(len(both[0][seed, start]) for seed in seeds for start in starts)
        apart = ", ".join(f"{x:+.3f}" for x in (varied - clean).mean(axis=1))
        cells = [cell(each.mean(axis=0), draws) for each in (clean, varied, varied - clean)]
        print(f"| {label} | {number} | {' | '.join(cells)} | {apart} |")


def main() -> None:
    """Do what is asked."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("what", choices=("settings", "compare"))
    parser.add_argument("folder", type=Path)
    arguments = parser.parse_args()
    {"settings": write_settings, "compare": compare}[arguments.what](arguments.folder)


if __name__ == "__main__":
    main()
