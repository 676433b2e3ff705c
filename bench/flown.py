"""Draw how the flown drone answers steps of its command: `python bench/flown.py PICTURE.png`.

Needs the extra `plots`. The picture in docs/trackers.md is made by it.
"""

import sys

import numpy as np
from numpy.typing import NDArray

from eyas.benchmark.report.plots import require_matplotlib
from eyas.engine.sim.build import build_simulation
from eyas.engine.sim.config import SimConfig
from eyas.engine.sim.worlds import each_alone
from eyas.engine.task.config import StartConfig, StartVelocity
from eyas.engine.trackers.config import TrackerConfig

SPEEDS, STEPS = (2.0, 5.0, 10.0), 3000
COLOURS = ("#9db9cc", "#1b6ca8", "#c8553d")


def flight(tracker: TrackerConfig) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return speed ahead [m/s] and pitch [rad] in each step, shape (K, speeds)."""
    start = StartConfig(velocity=StartVelocity.REST)
    simulation = build_simulation(SimConfig(tracker=tracker, start=start), each_alone(len(SPEEDS)))
    simulation.reset()
    state = simulation.snapshot.trackers
    yaw = state.euler[:, 2].copy()
    command = np.zeros((len(SPEEDS), 4))
    command[:, 0] = SPEEDS
    speed, pitch = np.zeros((STEPS, len(SPEEDS))), np.zeros((STEPS, len(SPEEDS)))
    for k in range(STEPS):
        simulation.advance(command)
        speed[k] = np.cos(yaw) * state.velocity[:, 0] + np.sin(yaw) * state.velocity[:, 1]
        pitch[k] = state.euler[:, 1]
    return speed, pitch


def main() -> None:
    """Fly, and draw."""
    figure = require_matplotlib()(figsize=(8.0, 5.2), layout="constrained", dpi=120)
    above, below = figure.subplots(2, 1, sharex=True, height_ratios=(3, 2))
    time = np.arange(1, STEPS + 1) * 0.002
    speed, pitch = flight(TrackerConfig(supervised=False))
    exact, _ = flight(TrackerConfig())
    for k, (asked, colour) in enumerate(zip(SPEEDS, COLOURS, strict=True)):
        above.plot(time, exact[:, k], color=colour, lw=1, ls=":")
        above.plot(time, speed[:, k], color=colour, lw=2, label=f"flown, {asked:g} m/s commanded")
        below.plot(time, np.degrees(pitch[:, k]), color=colour, lw=2)
    above.plot([], [], color="grey", lw=1, ls=":", label="supervised")
    below.axhline(36.0, color="grey", lw=1, ls="--")
    below.text(5.98, 34.5, "limit of the commanded tilt", ha="right", va="top", color="grey")
    above.set(ylabel="speed ahead [m/s]", xlim=(0, 6), ylim=(0, 17))
    below.set(ylabel="pitch, nose down [°]", xlabel="time since the command [s]")
    above.legend(frameon=False, loc="upper right")
    for axes in (above, below):
        axes.spines[["top", "right"]].set_visible(False)
    figure.savefig(sys.argv[1], metadata={"Software": None})


if __name__ == "__main__":
    main()
