"""Flies some episodes of each entry again, and compares the records to the byte.

No code of others runs: policies that are code, or files which hold some, and settings that name
code are refused, unless the user trusts whoever has sent them in.
"""

import math
import random
import secrets
from collections.abc import Iterator, Sequence
from enum import StrEnum
from hashlib import sha256
from itertools import accumulate
from pathlib import Path
from typing import NamedTuple

from eyas.benchmark.episodes.episode import EpisodeSpec, Place
from eyas.benchmark.flight.policy_runner import fly_batch
from eyas.benchmark.plan.entry import EntryClass, ResultEntry
from eyas.benchmark.plan.latency import PROFILES
from eyas.benchmark.plan.plan import EvaluationPlan, Stamp, batches, opened, stamp
from eyas.benchmark.policies.shipped import shipped_names
from eyas.benchmark.policies.table import FILES, FLIGHTS, POLICIES
from eyas.benchmark.records.record import EpisodeRecord
from eyas.benchmark.records.result import EPISODES
from eyas.benchmark.report.leaderboard.fresh import LEAST, MOST, fresh_figure
from eyas.benchmark.report.leaderboard.mark import MARK, Mark, content_hash, signed
from eyas.benchmark.report.leaderboard.submission import (
    ContradictionError,
    complete_run,
    folders_in,
)
from eyas.engine.core.config import Config
from eyas.engine.core.errors import ConfigError, EyasError
from eyas.engine.core.files import read_limited, write_atomic
from eyas.engine.core.identity.build import this_build
from eyas.engine.settings.env import EnvConfig
from eyas.engine.settings.trust import code_of

SHARE = 0.1  # Which part of the episodes is flown again, unless the user says so
_LARGEST = 1 << 31  # Largest size of a file of records [bytes]
_DATA = (".onnx", FLIGHTS)  # Endings of policies that are data: known operations, or actions


class EntryVerdict(StrEnum):
    """What is known of an entry."""

    VERIFIED = "verified"
    UNCONFIRMED = "equal, but not confirmed"  # By fresh episodes
    DIFFERENT = "not as flown"
    UNKNOWN = "not verifiable"


class EntryFinding(NamedTuple):
    """What was found of an entry."""

    folder: Path
    verdict: EntryVerdict
    why: str
    mark: Mark | None = None  # What was flown again, where the records are equal

    @property
    def line(self) -> str:
        """The line that is printed."""
        return f"{self.folder}: {self.verdict}: {self.why}"


class _UnverifiableError(EyasError):
    """Nothing can be said of an entry, and why."""


class _DifferenceError(EyasError):
    """The records are not those of the flights."""


def verify(
    folder: Path,
    *,
    share: float = SHARE,
    seed: int | None = None,
    fresh: int = 0,
    trust: bool = False,
) -> Iterator[EntryFinding]:
    """Fly a part of each entry again; yield what was found, and mark those that are equal.

    Episodes are flown in whole batches, as a network's last bits can depend on what it computes
    together.

    Args:
        share: Which part of the episodes, more than 0 and at most 1; at least one batch.
        seed: Which ones; None: drawn afresh.
        fresh: Number of episodes of secret seeds that are flown as well; 0: none.

    Raises:
        EyasError: There is no such folder, the share is wrong, or a mark cannot be written.
    """
    if not 0.0 < share <= 1.0:
        raise ConfigError(f"--share: {share:g} is not allowed: more than 0, at most 1")
    if fresh and not LEAST <= fresh <= MOST:
        raise ConfigError(f"--fresh: {fresh} is not allowed: 0, or {LEAST} to {MOST} episodes")
    seed = secrets.randbits(32) if seed is None else seed
    for path in folders_in(folder):
        try:
            mark = _flown_again(path, share, seed, fresh, trust=trust)
        except (_DifferenceError, ContradictionError) as error:
            (path / MARK).unlink(missing_ok=True)
            yield EntryFinding(path, EntryVerdict.DIFFERENT, str(error))
        except EyasError as error:
            yield EntryFinding(path, EntryVerdict.UNKNOWN, str(error))
        else:
            write_atomic(path / MARK, (signed(mark).model_dump_json(indent=1) + "\n").encode())
            found = f"{len(mark.flown)} of {mark.episodes} episodes (--seed {seed}) are equal"
            verdict = EntryVerdict.VERIFIED
            if mark.fresh is not None:
                found = f"{found}; {mark.fresh.line}"
                verdict = verdict if mark.fresh.confirmed else EntryVerdict.UNCONFIRMED
            yield EntryFinding(path, verdict, found, mark)


class JudgedRun(Config):
    """What was found of one evaluation."""

    verdict: EntryVerdict
    why: str
    content: str
    """Hash of its plan and records, see `eyas.benchmark.report.leaderboard.mark.content_hash`."""
    mark: Mark | None
    """What was flown again; None: its records are not those of its flights, or cannot be flown."""


class VerdictFile(Config):
    """What a machine says of an entry, to be signed by whoever runs it."""

    file: str
    """SHA-256 of the entry's zip file; empty for a folder."""
    build: str
    """Build of Eyas that has flown it."""
    runs: tuple[JudgedRun, ...]


def write_verdict(path: Path, entry: Path, found: Sequence[EntryFinding]) -> None:
    """Write what was found of an entry.

    Args:
        entry: Its zip file, or a folder.

    Raises:
        EyasError: A file cannot be read or written.
    """
    digest = sha256(read_limited(entry, _LARGEST)).hexdigest() if entry.is_file() else ""
    runs = tuple(
        JudgedRun(verdict=one.verdict, why=one.why, content=content_hash(one.folder), mark=one.mark)
        for one in found
    )
    verdict = VerdictFile(file=digest, build=this_build().id, runs=runs)
    write_atomic(path, (verdict.model_dump_json(indent=1) + "\n").encode())


def _flown_again(folder: Path, share: float, seed: int, fresh: int, *, trust: bool) -> Mark:
    """Return the mark of an entry whose episodes are equal when they are flown again."""
    content = content_hash(folder)  # before anything is read of it
    made, entry, records = complete_run(folder)
    plan = _flyable(folder, made, entry, trust=trust)
    people = entry.entry_class is EntryClass.HUMAN  # they cannot be asked for fresh flights
    parts = batches(plan)
    _refuse_others(parts, records)
    chosen = random.Random(seed).sample(range(len(parts)), math.ceil(share * len(parts)))
    lines = read_limited(folder / EPISODES, _LARGEST).split(b"\n")
    starts = list(accumulate(map(len, parts), initial=0))
    flown: list[str] = []
    for number in sorted(chosen):
        again = [record for ended in fly_batch(plan, parts[number]) for record in ended]
        for place, record in enumerate(again, starts[number]):
            _compare(lines[place], records[place], record)
        flown += [record.name for record in again]
    return Mark(
        build=made.build.id,
        seed=seed,
        flown=tuple(flown),
        episodes=len(records),
        content=content,
        fresh=fresh_figure(plan, records, fresh) if fresh and not people else None,
    )


def _flyable(folder: Path, made: Stamp, entry: ResultEntry, *, trust: bool) -> EvaluationPlan:
    """Return the plan of an entry, with its policy where this machine has it."""
    plan = made.plan
    if plan.latency == "measured":
        raise _UnverifiableError("flown with --latency measured, which does not repeat")
    if not trust and not (plan.latency in PROFILES or _is_number(plan.latency)):
        raise _UnverifiableError(f"--latency {plan.latency!r} is a file: --trust reads it")
    plan = plan.model_copy(update={"policy": _policy_of(folder, plan.policy, trust=trust)})
    here = stamp(plan)
    if here.policy != made.policy:
        raise _UnverifiableError(f"the policy's file is another: {here.policy}, not {made.policy}")
    if here.rules != made.rules:
        raise _UnverifiableError(f"the code of its protocol '{plan.protocol}' is another here")
    if differs := made.other_build(here):
        raise _UnverifiableError(
            f"flown by build {made.build.id} of Eyas, which differs from this one in {differs}"
        )
    policy, true = opened(plan)
    _refuse_code(plan, policy.env, trust=trust)
    for name in ResultEntry.model_fields:
        old, new = getattr(entry, name), getattr(true, name)
        if old != new:
            raise _DifferenceError(f"its {name} is told as {old!s:.200}, but is {new!s:.200}")
    return plan


def holds_code(policy: str) -> bool:
    """Return whether a policy is code, or a file that may hold some, and flies only if trusted."""
    known = policy in POLICIES.built_in or policy in shipped_names()
    return not known and Path(policy).suffix not in _DATA


def _policy_of(folder: Path, said: str, *, trust: bool) -> str:
    """Return what to open for a policy: its name, or its file in the folder or where it was."""
    if said in POLICIES.built_in or said in shipped_names():
        return said
    if not trust and holds_code(said):
        raise _UnverifiableError(
            f"its policy {said!r} is code, or a file that holds some: --trust runs it"
        )
    if Path(said).suffix not in FILES:
        return said
    for path in (folder / Path(said).name, Path(said)):
        if path.is_file():
            return str(path)
    raise _UnverifiableError(f"its policy {said!r} is not there, nor {folder / Path(said).name}")


def _refuse_code(plan: EvaluationPlan, env: EnvConfig, *, trust: bool) -> None:
    if trust:
        return
    for place in _places(plan):
        episode = EpisodeSpec(place, 0.0, 0)
        for setting, name in code_of(plan.rules.settings_of(episode, env)):
            raise _UnverifiableError(f"it names code, {name!r} ({setting}): --trust runs it")


def _places(plan: EvaluationPlan) -> Iterator[Place]:
    for name in plan.maps:
        for weather in plan.weathers:
            for target in plan.followed:
                yield Place(name, weather, target)


def _refuse_others(parts: list[list[EpisodeSpec]], records: list[EpisodeRecord]) -> None:
    """Refuse records that are not those of the plan's episodes, batch by batch."""
    planned = {episode.name: episode for part in parts for episode in part}
    for record in records:
        if record.name not in planned:
            raise _DifferenceError(f"{record.name} is not an episode of the plan")
        _, direction, seed, *_ = planned[record.name]
        if (record.direction, record.seed) != (direction, seed):
            raise _DifferenceError(f"{record.name}: seed or direction are those of another episode")
    left = iter(records)
    for number, part in enumerate(parts, 1):
        names = {episode.name for episode in part}
        for record in (next(left) for _ in part):
            if record.name not in names:
                raise _DifferenceError(
                    f"{record.name} stands in batch {number}, where it was not flown"
                )


def _compare(line: bytes, told: EpisodeRecord, again: EpisodeRecord) -> None:
    """Refuse a record that is not that of the flight."""
    for name in EpisodeRecord.model_fields:
        old, new = getattr(told, name), getattr(again, name)
        if old != new and name != "traceback":  # which tells paths of the machine
            raise _DifferenceError(f"{told.name}: {name!r} is {old!r:.60}, flown again {new!r:.60}")
    if told.traceback is None and line != again.model_dump_json().encode():
        raise _DifferenceError(f"{told.name} is written in another way")


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True
