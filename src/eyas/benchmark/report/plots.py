"""Plots of an evaluation: reward over time, time until the loss, flights on the map."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from eyas.benchmark.episodes.episode import Place
from eyas.benchmark.episodes.target_losses import COVERED
from eyas.benchmark.protocols.protocol import Protocol
from eyas.benchmark.records.record import EpisodeRecord
from eyas.benchmark.statistics.intervals import survival
from eyas.engine.core.errors import MissingExtraError
from eyas.engine.core.files import atomic_path, refusals
from eyas.engine.sim.scenes import load_network

FOLDER = "plots"
Axes = Any  # matplotlib has no types
_FLIGHTS = 8  # Flights that are drawn on a map; more could not be told apart
_INK, _SECOND, _SOFT, _ROAD = "#1b6ca8", "#c8553d", "#9db9cc", "#d9d9d6"


def require_matplotlib() -> Any:  # noqa: ANN401  # a module
    """Return matplotlib's class of figures.

    Raises:
        MissingExtraError: It is not installed.
    """
    try:
        from matplotlib.figure import Figure
    except ImportError as error:
        raise MissingExtraError("a plot", "plots") from error
    return Figure


def draw_plots(
    folder: Path, protocol: Protocol, title: str, records: Sequence[EpisodeRecord]
) -> None:
    """Write `plots/reward.png`, `lost.png`, for each map `flights-<map>.png`, and `recovered.png`
    where cameras were covered.

    Raises:
        MissingExtraError: matplotlib is not installed.
        OutputError: A file cannot be written.
    """
    plots = folder / FOLDER
    with refusals(plots):
        plots.mkdir(exist_ok=True)
    horizon = protocol.steps * protocol.period
    save_plot(plots / "reward.png", title, lambda axes: _reward(axes, records, horizon))
    save_plot(plots / "lost.png", title, lambda axes: _lost(axes, records, horizon))
    covered = [record for record in records if record.variant in COVERED]
    if covered:
        save_plot(plots / "recovered.png", title, lambda axes: _recovered(axes, covered))
    for name in sorted({record.map for record in records}):
        own = [record for record in records if record.map == name][:_FLIGHTS]
        save_plot(
            plots / f"flights-{name.replace(':', '-')}.png",
            title,
            lambda axes, own=own: _flights(axes, own),
        )


def save_plot(path: Path, title: str, draw: Any) -> None:  # noqa: ANN401  # a function of axes
    """Write one plot, drawn by a function of matplotlib's axes.

    Raises:
        OutputError: The file cannot be written.
    """
    figure = require_matplotlib()(figsize=(7.0, 4.2), layout="constrained", dpi=120)
    axes = figure.add_subplot()
    axes.set_title(title, loc="left", fontsize="medium")
    axes.spines[["top", "right"]].set_visible(False)
    draw(axes)
    with atomic_path(path) as part:
        # Without the version of the library, the same records give the same bytes.
        figure.savefig(part, format="png", metadata={"Software": None})


def _reward(axes: Axes, records: Sequence[EpisodeRecord], horizon: float) -> None:
    """Draw the mean reward and its quartiles; flights that have ended early count as 0."""
    points = max(1, *(len(record.trace.reward) for record in records))
    table = np.zeros((len(records), points))
    for row, record in zip(table, records, strict=True):
        row[: len(record.trace.reward)] = record.trace.reward
    longest = max(record.duration for record in records)
    time = (np.arange(points) + 0.5) * longest / points
    low, middle, high = np.quantile(table, (0.25, 0.5, 0.75), axis=0)
    axes.fill_between(time, low, high, color=_SOFT, alpha=0.5, lw=0, label="middle half")
    axes.plot(time, middle, color=_INK, lw=1, ls="--", label="median")
    axes.plot(time, table.mean(axis=0), color=_INK, lw=2, label="mean")
    axes.set(xlabel="time [s]", ylabel="reward", xlim=(0, horizon), ylim=(-0.02, 1.02))
    axes.legend(frameon=False, loc="best")


def _lost(axes: Axes, records: Sequence[EpisodeRecord], horizon: float) -> None:
    """Draw the Kaplan-Meier curve of the share that is not lost yet."""
    seen = [record for record in records if record.found_after is not None]
    at, left = survival(
        [record.watched for record in seen], [record.lost_after is not None for record in seen]
    )
    axes.step([*at, horizon], [*left, left[-1]], where="post", color=_INK, lw=2)
    kept = [record.watched for record in seen if record.lost_after is None]
    if kept:
        share = [float(left[np.searchsorted(at, time, side="right") - 1]) for time in kept]
        axes.plot(kept, share, "|", color=_INK, ms=9, clip_on=False, label="ends without a loss")
        axes.legend(frameon=False, loc="best")
    axes.set(xlabel="time since the target was found [s]", ylabel="share not lost yet")
    axes.set(xlim=(0, horizon), ylim=(-0.02, 1.02))


def _recovered(axes: Axes, records: Sequence[EpisodeRecord]) -> None:
    """Draw how often the target is recovered against the time for which it was lost."""
    means = {
        length: float(np.mean(own))
        for name, length in COVERED.items()
        if (own := _of(name, records))
    }
    axes.plot([*means], [*means.values()], "o-", color=_INK, lw=2, clip_on=False)
    axes.set(xlabel="time covered [s]", ylabel="recovered within 15 s")
    axes.set(xlim=(0, max(COVERED.values())), ylim=(-0.02, 1.02))


def _of(variant: str, records: Sequence[EpisodeRecord]) -> list[float]:
    """Return the share that is recovered in each episode of a variant."""
    own = [record.figures["recovered"] for record in records if record.variant == variant]
    return [share for share in own if share is not None]


def _flights(axes: Axes, records: Sequence[EpisodeRecord]) -> None:
    """Draw the paths of drones and targets over the roads of their map."""
    network = load_network(*Place(records[0].map, "", "").town)
    for lane in np.split(network.lane_points, network.lane_first[1:-1]):
        axes.plot(*lane.T, color=_ROAD, lw=2, zorder=0)
    for number, record in enumerate(records):
        first = number == 0
        if not record.trace.drone:
            continue
        drone, target = np.array(record.trace.drone), np.array(record.trace.target)
        axes.plot(*target.T, color=_SECOND, lw=2, label="target" if first else None)
        axes.plot(*drone.T, color=_INK, lw=1, label="drone" if first else None)
        axes.plot(*drone[0], "o", color=_INK, ms=4, label="start" if first else None)
    axes.set_aspect("equal")
    axes.set(xlabel="east [m]", ylabel="north [m]")
    axes.legend(frameon=False, loc="center left", bbox_to_anchor=(1.0, 0.5))
