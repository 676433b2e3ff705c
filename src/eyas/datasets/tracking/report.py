"""What `eyas track` shows: a table, and two curves."""

from pathlib import Path
from typing import Any

import numpy as np
from rich.console import Console
from rich.table import Table

from eyas.benchmark.report.plots import Axes, save_plot
from eyas.datasets.tracking.film import FILMS
from eyas.datasets.tracking.run import BOXES

_MOST_CLIPS = 20  # That are listed where none is scored


def print_figures(out: Path, results: dict[str, Any]) -> None:
    """Print the figures of all frames and of each stratum; without truth, what was tracked."""
    console = Console()
    console.width = max(console.width, 100)  # else a pipe would cut the numbers
    if not results["all"]["frames"]:
        _print_tracked(console, out, results)
        return
    table = Table(title=f"{results['tracker']} on {results['data']}")
    table.add_column("frames", no_wrap=True)
    titles = ("number", "AO", "95 %", "SR.50", "SR.75", "prec.", "succ.")
    for title in titles:
        table.add_column(title, justify="right", no_wrap=True)
    table.add_row("all", *_row(results["all"]))
    for criterion, values in results["strata"].items():
        table.add_section()
        for value, figures in values.items():
            if figures["frames"]:
                table.add_row(f"{criterion}: {value}", *_row(figures))
    console.print(table)
    console.print(f"figures in {out}", highlight=False, markup=False, soft_wrap=True)


def _print_tracked(console: Console, out: Path, results: dict[str, Any]) -> None:
    """Print what was tracked of clips that have no true boxes to score it by."""
    lines = [f"{results['tracker']} on {results['data']}: no true boxes, so no figures"]
    for name, single in list(results["episodes"].items())[:_MOST_CLIPS]:
        found = single["tracked"] - single["lost"]
        lines.append(f"{name}: a box in {found} of {single['tracked']} frames after the first")
    if len(results["episodes"]) > _MOST_CLIPS:
        lines.append(f"and {len(results['episodes']) - _MOST_CLIPS} others")
    lines.append(f"boxes in {out / BOXES}")
    lines += [f"film {path}" for path in sorted((out / FILMS).glob("*"))]
    for line in lines:
        console.print(line, highlight=False, markup=False, soft_wrap=True)


def _row(figures: dict[str, Any]) -> list[str]:
    if not figures["frames"]:
        return ["0"]
    interval = figures["ao_interval"]
    told = f"{interval[0]:.3f}-{interval[1]:.3f}" if interval else "-"
    names = ("sr50", "sr75", "precision", "success")
    numbers = [f"{figures[name]:.3f}" for name in names]
    return [str(figures["frames"]), f"{figures['ao']:.3f}", told, *numbers]


def draw_curves(out: Path, results: dict[str, Any]) -> None:
    """Write `success.png` and `precision.png`.

    Raises:
        MissingExtraError: matplotlib is not installed.
        OutputError: A file cannot be written.
    """
    title = f"{results['tracker']} on {results['data']}"

    def success(axes: Axes) -> None:
        axes.plot(np.linspace(0.0, 1.0, 101), results["curves"]["success"], color="#1b6ca8")
        axes.set(xlabel="overlap above", ylabel="share of frames", xlim=(0, 1), ylim=(0, 1))

    def precision(axes: Axes) -> None:
        axes.plot(np.arange(51), results["curves"]["precision"], color="#1b6ca8")
        axes.set(xlabel="centre within [pixels]", ylabel="share of frames", xlim=(0, 50))
        axes.set_ylim(0, 1)

    save_plot(out / "success.png", title, success)
    save_plot(out / "precision.png", title, precision)
