"""The tables of figures that the documents print, each as the evaluations that make it."""

import json
from collections.abc import Iterator, Mapping, Sequence
from importlib.resources import files
from typing import NamedTuple

from eyas.core.config import Config, validated
from eyas.core.errors import UnknownNameError
from eyas.evaluation.plan import EvaluationPlan
from eyas.evaluation.setting_out import AT_REST, AT_SPEED

__all__ = ["TABLES", "Expected", "ExpectedRow", "Row", "Table", "expected", "table_named"]

THREE_SETS = (1_000_000, 11_000_000, 21_000_000)
"""First seeds of three sets of episodes: one lucky set is then seen as one."""

FLOWN_SETS = (1_000_000, 2_000_000, 3_000_000)
"""Those of the tracker's other figures, see docs/following-one-target.md."""


class Row(NamedTuple):
    """A row of a table: one evaluation, or those of its episodes that begin alike."""

    label: str
    plan: EvaluationPlan
    part: str = "all"
    """A variant of the protocol."""

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
    page: str
    """The document, in `docs`."""
    title: str
    columns: tuple[str, ...]
    """Figures, as in `result.json`."""
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
    """The digest of its world, see `eyas.core.build.Build.world`."""
    rows: tuple[ExpectedRow, ...]


def expected(name: str) -> Expected | None:
    """Return what a table has to be; None: nobody has made it yet."""
    path = files("eyas.modes.reproduce") / "expected" / f"{name}.json"
    if not path.is_file():
        return None
    return validated(Expected, json.loads(path.read_text()), str(path))


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
_LASTING = ("hover", *_ORACLES)
_PAPER = ("cr", "tsr", "flawless", "worst_fifth")
_RECOVERED = ("recovered", "recovery_time", "followed_wrong", "nt2f", "tsr")
_BY_LENGTH = ("recovered", "recovered_2s", "recovered_5s", "recovered_10s", "recovered_15s")
_SEERS = ("hover", "sighted", "constant-velocity")
_SHORT = (*_SEERS, "fast", "eyas")


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
        "unseen",
        "protocols/unseen.md",
        "`unseen`, six towns by day",
        _PAPER[1:],
        _flown("unseen", _SHORT),
    )


def _long_flights() -> Iterator[Table]:
    for name, policies, columns, page in (
        ("recover", _LASTING, _RECOVERED, "recover"),
        ("recover-camera", _SEERS, _BY_LENGTH, "recover"),
        ("evade", _SEERS, ("kept", "held", "losses", "tsr"), "evade"),
    ):
        yield Table(name, f"protocols/{page}.md", f"`{name}`", columns, _flown(name, policies))
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
            "referring",
            ("hover", "follow", "attribute-servo", "eyas-words"),
            seeds=THREE_SETS[1:2],
        ),
    )


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
