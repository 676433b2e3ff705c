"""What the commands of this house do, as functions of Python; `eyas` offers them by these names."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypedDict, Unpack

if TYPE_CHECKING:
    from eyas.benchmark.records.record import EpisodeRecord

Names = str | Sequence[str]


class EvaluationChoices(TypedDict, total=False):
    """What an evaluation flies, by keyword."""

    map: Names
    """A map, or several; by default citystreet."""
    weather: Names
    """A weather, or several; by default day."""
    target: Names
    """A target, or several; by default SUMO_VEHICLE."""
    episodes: int
    """Episodes of each place and start direction; by default the protocol's number."""
    seeds: int | Sequence[int]
    """Seed of the first episode of each set of episodes: one, or several."""
    latency: str
    """Milliseconds, a profile such as `openfly`, a file with one in each line, or `measured`."""
    sampled: bool
    """Whether a network's actions are sampled, not the best ones."""
    env: Mapping[str, Any]
    """Changes of what the policy sees and does, settings of `env`."""
    settings: Mapping[str, Any]
    """Changes of `tracker`, `control`, `camera`, `start.velocity` and `extras`: another
    protocol."""
    batch: int
    """Episodes that are flown together."""


def evaluate(
    policy: str,
    protocol: str = "paper",
    out: Path | str | None = None,
    *,
    resume: bool = False,
    overwrite: bool = False,
    quiet: bool = True,
    **choices: Unpack[EvaluationChoices],
) -> "list[EpisodeRecord]":
    """Fly a policy in the episodes of a protocol, like `eyas evaluate`; return their records.

    Args:
        policy: A name of `list_policies()`, a file, or `package.module:name`.
        protocol: A name of `list_protocols()`, or `package.module:NAME`.
        out: The folder; by default `runs/evaluation/<policy>-<protocol>`.
        resume: Whether an evaluation in the folder is continued.
        overwrite: Whether one in the folder is deleted first.
        quiet: Whether nothing is printed but failures of the policy.
        choices: `map`, `weather`, `target`: a name or several; `episodes`, `seeds`, `latency`,
            `sampled`, `env`, `settings`, `batch`: see `EvaluationChoices` in this module.

    Raises:
        EyasError: A setting is wrong, or the folder; one line.
    """
    from eyas.benchmark.evaluation import run
    from eyas.benchmark.plan.plan import EvaluationPlan, folder_name
    from eyas.engine.core.config import validated
    from eyas.engine.core.errors import UnknownNameError

    for name in choices:
        if name not in EvaluationChoices.__annotations__:
            raise UnknownNameError("keyword", name, EvaluationChoices.__annotations__)
    said: dict[str, Any] = {"policy": policy, "protocol": protocol, **choices}
    for name in ("map", "weather", "target"):
        if name in said:
            names = said.pop(name)
            said[f"{name}s"] = [names] if isinstance(names, str) else list(names)
    if isinstance(said.get("seeds"), int):
        said["seeds"] = [said["seeds"]]
    plan = validated(EvaluationPlan, said)
    folder = Path(out) if out is not None else Path("runs/evaluation") / folder_name(plan)
    return run(plan, folder, resume=resume, overwrite=overwrite, quiet=quiet)


def list_policies() -> tuple[str, ...]:
    """Return the names of the policies: of Eyas, and of packages that are installed."""
    from eyas.benchmark.policies.table import policy_names

    return policy_names()


def list_protocols() -> tuple[str, ...]:
    """Return the names of the protocols: of Eyas, and of packages that are installed."""
    from eyas.benchmark.protocols.table import PROTOCOLS

    return PROTOCOLS.names()
