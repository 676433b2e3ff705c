"""The tables of figures that the documents print, each as the evaluations that make it."""

import json
from collections.abc import Iterator, Mapping, Sequence
from importlib.resources import files
from typing import Any, NamedTuple

from eyas.benchmark.episodes.setting_out import AT_REST, AT_SPEED
from eyas.benchmark.plan.plan import EvaluationPlan
from eyas.benchmark.policies.shipped import shipped_names
from eyas.benchmark.policies.table import WAITERS, fingerprint
from eyas.benchmark.protocols.mission import STAGES
from eyas.engine.core.config import Config, validated
from eyas.engine.core.errors import UnknownNameError

THREE_SETS = (1_000_000, 11_000_000, 21_000_000)
"""First seeds of three sets of episodes: one lucky set is then seen as one."""

FLOWN_SETS = (1_000_000, 2_000_000, 3_000_000)
"""Protocols of the tracker's other figures, see docs/following-one-target.md."""


class Row(NamedTuple):
    """A row of a table: one evaluation, or those of its episodes that begin alike."""

    label: str
    plan: EvaluationPlan
    part: str = "all"  # A variant of the protocol

    @property
    def episodes(self) -> int:
        """Number of its episodes."""
        parts = 1 if self.part == "all" else len(self.plan.rules.variants)
        return self.plan.count // parts

    @property
    def evaluation(self) -> str:
        """Name of the evaluation, which the parts share."""
        return self.label.removesuffix(f", {self.part}")


class Table(NamedTuple):
    """A table of a document."""

    name: str
    page: str  # The document, in `docs`
    title: str
    columns: tuple[str, ...]  # Figures, as in `result.json`.
    rows: tuple[Row, ...]


class ExpectedRow(Config):
    """What a row of a table has to be."""

    label: str
    n: int
    """Number of episodes."""
    cells: dict[str, str]
    """The figures by name, as printed."""
    build_id: str | None = None
    """The build that has made the row, if it is an earlier one than the table's."""


class Expected(Config):
    """What a table has to be."""

    build_id: str
    """The build of Eyas that has made it."""
    world: str
    """The digest of its world, see `eyas.engine.core.identity.build.Build.world`."""
    flown_with: dict[str, str]
    """Hashes of the protocols and of the shipped policies that have flown it, by name."""
    rows: tuple[ExpectedRow, ...]


def expected(name: str) -> Expected | None:
    """Return what a table has to be; None: nobody has made it yet."""
    path = files("eyas.benchmark.report.reproduce") / "expected" / f"{name}.json"
    if not path.is_file():
        return None
    return validated(Expected, json.loads(path.read_text()), str(path))


def flown_with(table: Table) -> dict[str, str]:
    """Return the hashes, as they are now, of a table's protocols and shipped policies by name."""
    plans = [row.plan for row in table.rows]
    hashes: dict[str, set[str]] = {}  # settings of a plan make another hash
    for plan in plans:
        hashes.setdefault(f"protocol {plan.protocol}", set()).add(plan.rules.hash)
    protocols = {name: " ".join(sorted(found)) for name, found in hashes.items()}
    policies = {plan.policy for plan in plans} & set(shipped_names())
    return protocols | {f"policy {name}": str(fingerprint(name)) for name in sorted(policies)}


def flown_of(policy: str) -> dict[str, list[tuple[Row, ExpectedRow, str]]]:
    """Return the rows of a policy by the name of their table, each with the build that flew it."""
    found: dict[str, list[tuple[Row, ExpectedRow, str]]] = {}
    for table in TABLES.values():
        said = expected(table.name)
        for row, one in zip(table.rows, said.rows if said else (), strict=said is not None):
            if row.plan.policy == policy:
                assert said is not None
                build = one.build_id or said.build_id
                found.setdefault(table.name, []).append((row, one, build))
    return found


def table_named(name: str) -> Table:
    """Return a table.

    Raises:
        UnknownNameError: There is no such table.
    """
    if name not in TABLES:
        raise UnknownNameError("TABLE", name, TABLES)
    return TABLES[name]


def _rows(
    policies: Sequence[str],
    places: Sequence[tuple[str, str]] = (("citystreet", "day"),),
    **common: object,
) -> Iterator[Row]:
    for map_name, weather in places:
        for policy in policies:
            place = "" if len(places) == 1 else f", {map_name} by {weather}"
            yield Row(
                f"`{policy}`{place}",
                EvaluationPlan(policy=policy, maps=(map_name,), weathers=(weather,), **common),
            )


_BY_DAY = tuple((name, "day") for name in ("citystreet", "downtown", "village"))
_CONDITIONS = tuple(
    (name, weather)
    for name in ("citystreet", "downtown", "village", "lake", "desert", "farmland")
    for weather in ("day", "night", "foggy", "snow")
)
_ORACLES = ("follow", "sighted", "road-graph", "constant-velocity")
_LASTING = ("hover", *_ORACLES, "wait-45")
_PAPER = ("cr", "tsr", "flawless", "worst_fifth")
_RECOVERED = ("recovered", "recovery_time", "followed_wrong", "nt2f", "tsr")
_BY_LENGTH = ("recovered", "recovered_2s", "recovered_5s", "recovered_10s", "recovered_15s")
_SEERS = ("hover", "sighted", "constant-velocity")
_SHORT = (*_SEERS, "fast", "eyas")
_KEPT = ("kept", "tsr", "losses_per_hour", "found_again")
_ENDS: tuple[tuple[str, str, tuple[str, ...], tuple[str, ...]], ...] = (
    ("air", "air", ("hover", "sighted", "eyas"), _KEPT),
    (
        "recover-wide",
        "recover",
        ("hover", *WAITERS, "constant-velocity", "road-graph", "sighted", "eyas"),
        ("recovered", "recovery_time", "followed_wrong", "tsr"),
    ),
    ("mission", "mission", ("hover", "sighted", "eyas-words"), ("score", *STAGES)),
    (
        "crowd",
        "crowd",
        ("hover", "servo", "sighted", "eyas"),
        ("kept_share", "identity_switches", "kept", "tsr"),
    ),
    (
        "coat",
        "crowd",
        ("hover", "sighted", "eyas"),
        ("kept_share", "kept_before", "kept_after", "tsr"),
    ),
)
"""Tables with the floor, the ceiling and the best policy that ships, in one set of episodes."""

_FLIGHT_CONTROLLER: dict[str, Any] = {
    "tracker": {"supervised": False, "flight": "mended"},
    "start": {"velocity": "target"},
}
"""A drone that its flight controller flies, and that begins at its target's velocity."""


def _short_flights() -> Iterator[Table]:
    yield Table(
        "baselines",
        "evaluation.md",
        "Built-in policies in `paper`, citystreet by day",
        _PAPER,
        tuple(_rows(("hover", "random", "servo", *_ORACLES), seeds=THREE_SETS)),
    )
    yield Table(
        "paper",
        "protocols/paper.md",
        "Shipped policies in `paper`",
        _PAPER,
        tuple(_rows(("sighted", "fast", "eyas"), _BY_DAY, seeds=THREE_SETS)),
    )
    yield Table(
        "standard",
        "protocols/standard.md",
        "`standard`",
        _PAPER[1:],
        tuple(_rows(_SHORT, _BY_DAY, protocol="standard")),
    )
    yield Table(
        "conditions",
        "following-one-target.md",
        "`eyas` on all maps in all weathers, `standard`",
        _PAPER[1:],
        tuple(_rows(("eyas",), _CONDITIONS, protocol="standard")),
    )
    yield Table(
        "targets",
        "following-one-target.md",
        "`eyas` and `eyas-flown` in `paper`: other targets, late actions, flown drones",
        _PAPER,
        tuple(_other_targets()),
    )
    yield Table(
        "unseen",
        "protocols/unseen.md",
        "`unseen`, six towns by day",
        _PAPER[1:],
        _flown("unseen", _SHORT),
    )


def _other_targets() -> Iterator[Row]:
    for label, changes in (
        ("80 ms late", {"latency": "80"}),
        ("`Pedestrian`", {"targets": ("Pedestrian",)}),
        ("`GhostDog`", {"targets": ("GhostDog",)}),
    ):
        yield Row(f"`eyas`, {label}", EvaluationPlan(policy="eyas", seeds=FLOWN_SETS, **changes))
    for label, changes in (
        ("citystreet", {}),
        ("downtown", {"maps": ("downtown",)}),
        ("citystreet, 40 ms late", {"latency": "40"}),
    ):
        plan = EvaluationPlan(policy="eyas-flown", settings=_FLIGHT_CONTROLLER, **changes)
        yield Row(f"`eyas-flown`, {label}", plan)


def _lasting() -> Iterator[Row]:
    for protocol, maps in (("long", ("citystreet", "downtown")), ("distractor", ("citystreet",))):
        for map_name in maps:
            for policy in ("hover", "sighted", "constant-velocity", "fast", "eyas"):
                seeds = FLOWN_SETS if policy == "eyas" else FLOWN_SETS[:1]
                plan = EvaluationPlan(
                    policy=policy, protocol=protocol, maps=(map_name,), seeds=seeds
                )
                yield Row(f"`{policy}`, `{protocol}` in {map_name} by day", plan)


def _long_flights() -> Iterator[Table]:
    yield Table(
        "lasting",
        "protocols/lasting.md",
        "`long` and `distractor`",
        ("tsr", "kept", "losses", "found_again"),
        tuple(_lasting()),
    )
    for name, policies, columns, page in (
        ("recover", _LASTING, _RECOVERED, "recover"),
        ("recover-camera", _SEERS, _BY_LENGTH, "recover"),
        ("evade", _SEERS, ("kept", "held", "losses", "tsr"), "evade"),
    ):
        rows = _flown(name, policies)
        seeds = FLOWN_SETS if name == "recover" else FLOWN_SETS[:1]
        rows += _flown(name, ("eyas",), seeds=seeds)
        yield Table(name, f"protocols/{page}.md", f"`{name}`", columns, rows)
    for own, where, flyers, figures in _ENDS:
        yield Table(own, f"protocols/{where}.md", f"`{own}`", figures, _flown(own, flyers))
    yield Table(
        "flown",
        "protocols/flown.md",
        "`flown`, citystreet by day",
        ("tsr", "kept", "flawless", "worst_fifth", "crashed"),
        tuple(_by_start()),
    )
    yield Table(
        "referring",
        "protocols/referring.md",
        "`referring`, seeds that no baseline was tuned on",
        ("language_gap", "success_right", "success_other", "chosen"),
        _flown(
            "referring", ("hover", "follow", "attribute-servo", "eyas-words"), seeds=THREE_SETS[1:2]
        ),
    )
    yield Table(
        "referring-weathers",
        "following-words.md",
        "`eyas-words` on both maps in four weathers, `referring`",
        ("language_gap", "success_right", "success_other", "chosen"),
        tuple(_in_weathers()),
    )


def _in_weathers() -> Iterator[Row]:
    for map_name in ("citystreet", "downtown"):
        for weather in ("day", "night", "foggy", "snow"):
            plan = EvaluationPlan(
                policy="eyas-words",
                protocol="referring",
                maps=(map_name,),
                weathers=(weather,),
                episodes=13,  # one of each kind of phrase and number of look-alikes
                seeds=THREE_SETS[1:2],
            )
            yield Row(f"`eyas-words`, {map_name} by {weather}", plan)


def _by_start() -> Iterator[Row]:
    for policy in ("hover", "constant-velocity", "sighted", "follow", "eyas-flown"):
        seeds = FLOWN_SETS if policy == "eyas-flown" else FLOWN_SETS[:1]
        plan = EvaluationPlan(policy=policy, protocol="flown", seeds=seeds)
        for part in (AT_SPEED, AT_REST):
            yield Row(f"`{policy}`, {part}", plan, part)


def _flown(protocol: str, policies: Sequence[str], **common: object) -> tuple[Row, ...]:
    return tuple(
        Row(f"`{policy}`", EvaluationPlan(policy=policy, protocol=protocol, **common))
        for policy in policies
    )


TABLES: Mapping[str, Table] = {table.name: table for table in (*_short_flights(), *_long_flights())}
"""All tables by name."""
