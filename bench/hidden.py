"""How much each map hides from a drone that follows exactly: share of looks without the target.

    python bench/hidden.py        # all maps by day; or name some

Each of 24 drones is carried with a car of its own for 60 s, behind it, and looks every 0.1 s: from
22 m straight down (pitch 1.37 rad), and from 15 m ahead (0.6 rad), as the gallery does. A target is
hidden if a tenth or less of what it would cover is seen, and in part if nine tenths or less.
"""

import sys

import numpy as np

from eyas.engine.core.config import validated
from eyas.engine.sim.build import build_simulation
from eyas.engine.sim.config import SimConfig
from eyas.engine.sim.worlds import each_alone
from eyas.engine.state.draw import DrawStage, Picture
from eyas.engine.world.maps import MAPS

DRONES, SECONDS, EVERY = 24, 60.0, 0.1
POSES = ((22.0, 1.37), (15.0, 0.6))
HIDDEN, PARTLY = 0.1, 0.9


def shares(map_name: str, height: float, pitch: float) -> tuple[float, float]:
    """Return the shares of looks in which a target is hidden, and hidden at least in part."""
    config = validated(
        SimConfig,
        {
            "seed": 1,
            "world": {"map": map_name},
            "start": {"height": height, "pitch": pitch},
            "done": {"total_steps": 40_000},
        },
    )
    simulation = build_simulation(config, each_alone(DRONES))
    simulation.reset()
    picture = Picture.create(DRONES, 84, 84, rgb=False, class_id=True, subject=True)
    seen = []
    for _ in range(round(SECONDS / EVERY)):
        simulation.carry(round(500 * EVERY))
        simulation.draw(np.arange(DRONES, dtype=np.int32), picture, until=DrawStage.RASTERISING)
        pixels = picture.subject_pixels
        assert pixels is not None
        seen.append(pixels[:, 0] / np.maximum(pixels[:, 1], 1))
    part = np.array(seen)
    return float((part <= HIDDEN).mean()), float((part <= PARTLY).mean())


def main() -> None:
    """Print a row for each map."""
    print("| map | 22 m: hidden | in part | 15 m, ahead: hidden | in part |\n|---|---|---|---|---|")
    names = sys.argv[1:] or [name for name in MAPS.built_in if "day" in MAPS.get(name).weathers]
    for name in names:
        row = [100 * share for pose in POSES for share in shares(name, *pose)]
        print(f"| {name} | " + " | ".join(f"{share:.1f} %" for share in row) + " |", flush=True)


if __name__ == "__main__":
    main()
