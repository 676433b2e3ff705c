"""Evaluates a policy: flies the episodes of a protocol, and writes records and figures."""

import json
import logging
import os
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from hashlib import sha256
from pathlib import Path

import numpy as np
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

from eyas.benchmark.episodes.episode import EpisodeSpec
from eyas.benchmark.flight.policy_runner import Runner, run_here
from eyas.benchmark.plan.plan import EvaluationPlan, Stamp, batches, check, stamp
from eyas.benchmark.records.croissant import croissant
from eyas.benchmark.records.record import EpisodeRecord, RecordFile, order_records, read_records
from eyas.benchmark.records.result import (
    EPISODES,
    RESULT,
    ROWS,
    STAMP,
    load_run,
    table,
    write_result,
)
from eyas.benchmark.report import films as evaluation_films
from eyas.benchmark.report import plots as evaluation_plots
from eyas.benchmark.report.films import film
from eyas.benchmark.report.plots import draw_plots, require_matplotlib
from eyas.engine.core.codecs.pyav import pyav
from eyas.engine.core.errors import ConfigError, OutputError
from eyas.engine.core.files import refusals, write_atomic
from eyas.engine.core.folder_lock import folder_lock
from eyas.engine.core.machine import describe_machine
from eyas.engine.terminal.ending import print_ending

_LOG = logging.getLogger("eyas")
CROISSANT = "croissant.json"  # What the episodes are, for machines
TIMING = "timing.json"  # How long the policy takes; apart from the result, which repeats


def run(
    plan: EvaluationPlan,
    out: Path,
    *,
    resume: bool = False,
    overwrite: bool = False,
    as_published: bool = False,
    plots: bool = False,
    videos: bool = False,
    quiet: bool = False,
    runner: Runner = run_here,
) -> list[EpisodeRecord]:
    """Fly all episodes of a plan, or those that are missing in the folder; print a table.

    Args:
        as_published: Whether the figures are those that the original's code would have printed.
        runner: Flies the batches; `one_shard` leaves some to others, and then there are no figures.

    Raises:
        EyasError: A setting is wrong, or the folder is taken.
    """
    entry = check(plan)
    if plots:
        require_matplotlib()
    if videos:
        pyav("--videos")
    made = stamp(plan).model_copy(update={"entry": entry})
    with folder_lock(out, "evaluating into it"):
        records = _prepared(out, made, resume=resume, overwrite=overwrite)
        _fly(plan, out, records, runner, quiet=quiet)
        found = read_records(out / EPISODES)
        if len(found) < plan.count:
            _say_share(out, len(found), plan.count, quiet=quiet)
            return found
        flown = _in_order(plan, out)
        rows = write_result(out, made, flown, as_published=as_published)
        _write_croissant(out, made)
        if plots:
            draw_plots(out, plan.rules, f"{plan.policy}, protocol {plan.protocol}", flown)
        if videos:
            film(out, plan, flown)
    if not quiet:
        print(
            f"{plan.policy}, protocol {plan.protocol} {made.protocol}"
            f"{'' if made.rules is None else f' of {made.rules}'}, Eyas {made.version}, "
            f"build {made.build.id}, class {entry.entry_class}"
        )
        print(table(rows, plan.protocol))
    _tell_failures(flown)
    if not quiet:
        print_ending(
            f"{len(flown)} episodes in {out} ({EPISODES}, {RESULT})",
            ("compare it with another", ("eyas", "compare", "FOLDER", out)),
            ("make an entry for a leaderboard", ("eyas", "leaderboard", "pack", out)),
        )
    return flown


def _prepared(out: Path, made: Stamp, *, resume: bool, overwrite: bool) -> list[EpisodeRecord]:
    """Return the records that the folder has; write the stamp into an empty one."""
    path = out / STAMP
    if overwrite:
        _delete(out)
    if not path.exists() and not (out / EPISODES).exists():
        write_atomic(path, (made.model_dump_json(indent=1) + "\n").encode())
        return []
    if not resume:
        raise OutputError(
            f"{out}: an evaluation is already there; continue it with --resume, or replace it "
            "with --overwrite"
        )
    found, records = load_run(out, trust=True)  # it must be the protocol that the user names
    _require_same(out, found, made)
    return records


def join_shards(plan: EvaluationPlan, out: Path, shards: Sequence[Path]) -> None:
    """Write the episodes of shards into a folder, which `run` then continues.

    Raises:
        EyasError: A setting is wrong, or one of the folders has an evaluation of something else.
    """
    made = stamp(plan).model_copy(update={"entry": check(plan)})
    flown = []
    for folder in shards:  # before anything is written
        found, records = load_run(folder, trust=True)
        _require_same(folder, found, made)
        flown.append(records)
    with folder_lock(out, "evaluating into it"):
        known = {record.name for record in _prepared(out, made, resume=True, overwrite=False)}
        for records in flown:
            with RecordFile(out / EPISODES) as file:
                file.add(record for record in records if record.name not in known)
            known |= {record.name for record in records}
    if len(known) < plan.count:
        _LOG.warning(
            "--join: the folders have %d of %d episodes; the others are flown now",
            *(len(known), plan.count),
        )


def one_shard(runner: Runner, number: int, count: int) -> Runner:
    """Return a runner that flies every `count`-th batch of a plan, from the `number`-th, from 1."""

    def flown(
        plan: EvaluationPlan, left: list[list[EpisodeSpec]], answers: list[float]
    ) -> Iterator[list[EpisodeRecord]]:
        parts = batches(plan)
        if count > len(parts):
            raise ConfigError(
                f"--shard: '{number}/{count}' is not allowed: at most {len(parts)} shards, one "
                "for each batch; --batch makes smaller ones"
            )
        own = {part[0].name for part in parts[number - 1 :: count]}
        return iter(runner(plan, [part for part in left if part[0].name in own], answers))

    return flown


def _say_share(out: Path, flown: int, count: int, *, quiet: bool) -> None:
    if not quiet:
        print_ending(
            f"{flown} of {count} episodes in {out}; the same command with --join for each folder, "
            "without --shard, makes figures of all"
        )


def _require_same(out: Path, found: Stamp, made: Stamp) -> None:
    """Refuse a folder with an evaluation of something else.

    Raises:
        OutputError: Another build, protocol or policy has flown, or another plan.
    """
    if differs := found.other_build(made):
        raise OutputError(
            f"{out}: cannot be continued: flown by build {found.build.id} of Eyas, which differs "
            f"from this one in {differs}; continue with that build, or replace it with --overwrite"
        )
    for name in ("protocol", "rules", "policy"):
        old, new = getattr(found, name), getattr(made, name)
        if old != new:
            raise OutputError(f"{out}: cannot be continued: its {name} was {old}, now it is {new}")
    if found.entry != made.entry:
        raise OutputError(
            f"{out}: cannot be continued: what its policy sees or does has changed; replace it "
            "with --overwrite"
        )
    old_plan, new_plan = found.plan.model_dump(), made.plan.model_dump()
    for name in old_plan:
        if old_plan[name] != new_plan[name]:
            raise OutputError(
                f"{out}: cannot be continued: '{name}' was {old_plan[name]!r}, now it is "
                f"{new_plan[name]!r}"
            )


def _delete(out: Path) -> None:
    """Delete what an evaluation has written into its folder, and nothing else."""
    plots, videos = out / evaluation_plots.FOLDER, out / evaluation_films.FOLDER
    names = (STAMP, EPISODES, RESULT, ROWS, TIMING, CROISSANT)
    with refusals(out):
        for path in (*(out / name for name in names), *plots.glob("*.png"), *videos.glob("*.mp4")):
            path.unlink(missing_ok=True)


def _fly(
    plan: EvaluationPlan, out: Path, records: list[EpisodeRecord], runner: Runner, *, quiet: bool
) -> None:
    """Fly the batches that are not complete, and append the records that are missing."""
    known = {record.name for record in records}
    answers: list[float] = []
    parts = batches(plan)
    left = [part for part in parts if any(episode.name not in known for episode in part)]
    begun = time.perf_counter()
    with RecordFile(out / EPISODES) as file, _progress(sum(map(len, parts)), quiet=quiet) as tell:
        tell(len(known))
        for ended in runner(plan, left, answers):
            new = [record for record in ended if record.name not in known]
            file.add(new)
            known.update(record.name for record in new)
            tell(len(known))
    if answers:
        _write_timing(plan, out, answers, time.perf_counter() - begun)


def _in_order(plan: EvaluationPlan, out: Path) -> list[EpisodeRecord]:
    """Return the records in the order of the plan; in the file, put the batches in this order."""
    parts, found = batches(plan), read_records(out / EPISODES)
    batch = {episode.name: number for number, part in enumerate(parts) for episode in part}
    order_records(out / EPISODES, [batch[record.name] for record in found])
    named = {record.name: record for record in found}
    return [named[episode.name] for part in parts for episode in part]


@contextmanager
def _progress(total: int, *, quiet: bool) -> Iterator[Callable[[int], None]]:
    """Show the progress on stderr; yield what is told the number of flown episodes."""
    columns = (TextColumn("episodes"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
    console = Console(stderr=True)
    with Progress(*columns, console=console, transient=True, disable=quiet) as bar:
        task = bar.add_task("episodes", total=total)
        yield lambda flown: bar.update(task, completed=flown)


def _write_timing(plan: EvaluationPlan, out: Path, answers: list[float], wall: float) -> None:
    middle, most = (np.quantile(answers, (0.5, 0.95)) * 1e3).tolist()
    content = {
        "machine": describe_machine(),
        "processes": 1,
        "batch": 1 if plan.latency == "measured" else plan.batch,
        "answers": len(answers),
        "median_ms": middle,
        "p95_ms": most,
        "wall_s": wall,
        "load": os.getloadavg()[0] if hasattr(os, "getloadavg") else None,
    }
    write_atomic(out / TIMING, (json.dumps(content, indent=1) + "\n").encode())


def _write_croissant(out: Path, made: Stamp) -> None:
    digest = sha256((out / EPISODES).read_bytes()).hexdigest()
    write_atomic(out / CROISSANT, (json.dumps(croissant(made, digest), indent=1) + "\n").encode())


def _tell_failures(records: list[EpisodeRecord]) -> None:
    failed = [record for record in records if record.error is not None]
    if failed:
        first = failed[0]
        _LOG.warning(
            "the policy failed in %d of %d episodes, first in %s: %s%s",
            len(failed),
            len(records),
            first.name,
            first.error,
            "" if first.traceback is None else f"\n{first.traceback.rstrip()}",
        )
