"""TSR over the latency of the policy: one evaluation for each of five latencies."""

import json
from pathlib import Path
from typing import Any, TypedDict

from eyas.benchmark.evaluation import run
from eyas.benchmark.flight.policy_runner import Runner, run_here
from eyas.benchmark.plan.plan import EvaluationPlan, check, stamp
from eyas.benchmark.records.record import EpisodeRecord
from eyas.benchmark.records.result import cell
from eyas.benchmark.report.plots import require_matplotlib, save_plot
from eyas.benchmark.statistics.table_rows import rows_of
from eyas.engine.core.errors import ConfigError
from eyas.engine.core.files import write_atomic

LATENCIES = ("0", "20", "40", "80", "160")  # [ms]
CURVE = "latency"  # Name of the files of the curve, without ending
_FIGURES = ("tsr", "cr")


class _Point(TypedDict):
    """Means at one latency, with their 95 % intervals."""

    latency_ms: float
    figures: dict[str, tuple[float, float | None, float | None]]


def run_curve(
    plan: EvaluationPlan,  # The plan; it must not have a latency of its own
    out: Path,
    *,
    resume: bool,
    overwrite: bool,
    plots: bool,  # Whether `latency.png` is drawn
    quiet: bool,
    runner: Runner = run_here,
) -> list[EpisodeRecord]:
    """Evaluate at each latency, in a folder of its own, and write `latency.json`; return all
    records.

    Raises:
        EyasError: A setting is wrong, or a folder is taken.
    """
    if plan.latency != "0":
        raise ConfigError("--latency and --latency-curve cannot be used together")
    check(plan)
    if plots:
        require_matplotlib()
    points: list[_Point] = []
    every: list[EpisodeRecord] = []
    for latency in LATENCIES:
        own, folder = plan.model_copy(update={"latency": latency}), out / f"latency-{latency}"
        records = run(own, folder, resume=resume, overwrite=overwrite, quiet=True, runner=runner)
        every += records
        figures = rows_of(records, plan.rules)[0].figures
        found = {
            name: (figures[name].mean, *(figures[name].interval or (None, None)))
            for name in _FIGURES
        }
        points.append(_Point(latency_ms=float(latency), figures=found))
        if not quiet:
            cells = (f"{name} {cell(figures[name])}" for name in _FIGURES)
            print(f"{latency:>4} ms  " + "  ".join(cells), flush=True)
    made = stamp(plan).model_dump(mode="json")
    content = json.dumps({**made, "points": points}, indent=1) + "\n"
    write_atomic(out / f"{CURVE}.json", content.encode())
    if plots:
        title = f"{plan.policy}, protocol {plan.protocol}"
        save_plot(out / f"{CURVE}.png", title, lambda axes: _draw(axes, points))
    return every


def _draw(axes: Any, points: list[_Point]) -> None:  # noqa: ANN401  # matplotlib's
    time = [point["latency_ms"] for point in points]
    means, lows, highs = zip(*(point["figures"]["tsr"] for point in points), strict=True)
    if None not in lows:
        axes.fill_between(time, lows, highs, color="#9db9cc", alpha=0.5, lw=0, label="95 %")
    axes.plot(time, means, "o-", color="#1b6ca8", lw=2, label="mean")
    axes.set(xlabel="latency [ms]", ylabel="TSR", ylim=(0, 1.02), xticks=time)
    axes.legend(frameon=False, loc="best")
