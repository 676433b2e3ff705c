"""`eyas evaluate`, `compare`, `leaderboard`, `reproduce` and `policies`."""

import json
from contextlib import AbstractContextManager, nullcontext
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from eyas.engine.core.errors import ConfigError
from eyas.engine.terminal.options import (
    SEVERAL,
    AsJson,
    Overwrite,
    Plots,
    Private,
    Quiet,
    Ray,
    Resume,
    Shard,
    by_policy,
    parsed_shard,
    to_write,
)

if TYPE_CHECKING:
    from eyas.benchmark.flight.policy_runner import Runner

_Protocol = Annotated[
    str,
    typer.Option(
        "--protocol",
        help="paper, standard, unseen, long, search, ...: see docs/evaluation.md; or "
        "package.module:NAME.",
    ),
]
_Maps = Annotated[
    list[str] | None,
    typer.Option(
        "--map",
        help=f"By default citystreet; {SEVERAL}. A town of another seed: citystreet:900000001.",
    ),
]
_Weathers = Annotated[
    list[str] | None,
    typer.Option("--weather", help=f"By default the protocol's, mostly day; {SEVERAL}."),
]
_Targets = Annotated[
    list[str] | None,
    typer.Option("--target", help=f"By default the protocol's, mostly SUMO_VEHICLE; {SEVERAL}."),
]
_Episodes = Annotated[
    int | None,
    typer.Option("--episodes", help="For each map, weather, target and start direction."),
]
_Seed = Annotated[
    int | None, typer.Option("--seed", help="The one seed of the run: that of its first episode.")
]
_Seeds = Annotated[
    str | None,
    typer.Option(
        "--seeds",
        help="Several sets of episodes: the first seed of each, with commas, or their number.",
    ),
]
_Latency = Annotated[
    str,
    typer.Option(
        "--latency",
        help="Milliseconds, a published system's (openfly, spf, ...), a file of them, or measured.",
    ),
]
_LatencyCurve = Annotated[
    bool, typer.Option("--latency-curve", help="Evaluate at 0, 20, 40, 80 and 160 ms.")
]
_Sample = Annotated[
    bool, typer.Option("--sample", help="Sample a network's actions instead of taking the best.")
]
_InProcess = Annotated[
    bool,
    typer.Option(
        "--in-process",
        help="Fly your own code in this process, for a debugger: the class is then privileged.",
    ),
]
_Batch = Annotated[int, typer.Option("--batch", help="Episodes flown together.")]
_Changes = Annotated[
    list[str] | None,
    typer.Option(
        "--set",
        metavar="KEY=VALUE",
        help="Change a setting of env, what the policy sees and does; one of tracker, control, "
        "camera, start.velocity or extras makes another protocol.",
    ),
]
_AsPublished = Annotated[
    bool, typer.Option("--as-published", help="Figures as the original's code prints them.")
]
_Videos = Annotated[
    bool, typer.Option("--videos", help="Film the worst, the median and the best flight.")
]


def evaluate(
    policy: Annotated[str, by_policy("")],
    protocol: _Protocol = "paper",
    maps: _Maps = None,
    weathers: _Weathers = None,
    targets: _Targets = None,
    episodes: _Episodes = None,
    seed: _Seed = None,
    seeds: _Seeds = None,
    latency: _Latency = "0",
    latency_curve: _LatencyCurve = False,
    sample: _Sample = False,
    in_process: _InProcess = False,
    batch: _Batch = 64,
    set_: _Changes = None,
    out: Annotated[Path | None, to_write("Folder to write to.")] = None,
    as_published: _AsPublished = False,
    plots: Plots = False,
    videos: _Videos = False,
    resume: Resume = False,
    overwrite: Overwrite = False,
    ray: Ray = False,
    shard: Shard = None,
    join: Annotated[
        list[Path] | None,
        typer.Option(
            "--join", metavar="FOLDER", help=f"Take the episodes of a shard, too; {SEVERAL}."
        ),
    ] = None,
    quiet: Quiet = False,
) -> None:
    """Fly a policy in the episodes of a protocol, and measure how well it tracks.

    The exit code is 1 if the policy has failed in all episodes. `eyas evaluate --offline FOLDER`
    scores a box tracker on real sequences, as `eyas track` does.
    """
    from eyas.benchmark.episodes.episode import seed_sets
    from eyas.benchmark.plan.plan import EvaluationPlan, folder_name
    from eyas.engine.core.config import validated

    values: dict[str, Any] = {
        "policy": policy,
        "protocol": protocol,
        **({"maps": maps} if maps else {}),
        **({"weathers": weathers} if weathers else {}),
        "targets": targets,
        **{"episodes": episodes, "latency": latency, "sampled": sample, "batch": batch},
        "in_process": in_process,
    }
    changes = _changes(set_ or [])
    values |= {"env": changes.pop("env", {}), "settings": changes}
    if seed is not None and seeds is not None:
        raise ConfigError("--seed and --seeds cannot be used together")
    if seed is not None or seeds is not None:
        values["seeds"] = seed_sets(seeds) if seeds is not None else (seed,)
    plan = validated(EvaluationPlan, values)
    folder = out or Path("runs/evaluation") / folder_name(plan)
    if latency_curve and (as_published or videos or shard or join):
        raise ConfigError(
            "--latency-curve: not together with --as-published, --videos, --shard or --join"
        )
    if (shard and (join or plots or videos)) or (join and overwrite):
        raise ConfigError(
            "--shard: not together with --join, --plots or --videos; --join: not with --overwrite"
        )
    if ray and latency == "measured":
        raise ConfigError("--ray: not together with --latency measured: that is of this machine")
    with _runner(ray=ray) as runner:
        common: Any = {"resume": resume, "overwrite": overwrite, "plots": plots, "quiet": quiet}
        if latency_curve:
            from eyas.benchmark.report.latency_curve import run_curve

            records = run_curve(plan, folder, runner=runner, **common)
        else:
            from eyas.benchmark.evaluation import join_shards, one_shard, run

            own: Any = {"as_published": as_published, "videos": videos}
            if join:
                join_shards(plan, folder, join)
                common["resume"] = True
            part = parsed_shard(shard)
            runner = runner if part is None else one_shard(runner, *part)
            records = run(plan, folder, runner=runner, **own, **common)
    if all(record.error is not None for record in records):
        raise typer.Exit(1)


def _runner(*, ray: bool) -> "AbstractContextManager[Runner]":
    """Return what flies the batches."""
    if ray:
        from eyas.benchmark.flight.policy_runner import on_ray

        return on_ray()
    from eyas.benchmark.flight.policy_runner import run_here

    return nullcontext(run_here)


_FREE = (["start", "velocity"], ["extras"])
"""Settings that `--set` changes, besides all of some groups."""


def _changes(said: list[str]) -> dict[str, Any]:
    """Return changes from `env.key=value`, and of other rooms."""
    from eyas.engine.settings.file import parsed_override

    changes: dict[str, Any] = {}
    for text in said:
        keys, value = parsed_override(text)
        if keys[0] not in ("env", "tracker", "control", "camera") and keys not in _FREE:
            raise ConfigError(
                f"--set {text!r}: not allowed: env.KEY=VALUE, such as env.action_repeat=4, or "
                "tracker.KEY, control.KEY, camera.KEY, start.velocity or extras; all else "
                "belongs to the protocol"
            )
        group = changes
        for key in keys[:-1]:
            group = group.setdefault(key, {})
        group[keys[-1]] = value
    return changes


def compare(
    first: Annotated[Path, typer.Argument(metavar="A", help="Folder of an evaluation.")],
    second: Annotated[Path, typer.Argument(metavar="B", help="Folder of another.")],
    across_builds: Annotated[
        bool, typer.Option("--across-builds", help="Compare although Eyas itself differs.")
    ] = False,
    trust: Annotated[
        bool, typer.Option("--trust", help="Run the code of a protocol that they name by a path.")
    ] = False,
    json_: AsJson = False,
) -> None:
    """Compare two evaluations in the episodes that both have flown: how much B differs from A."""
    from eyas.benchmark.records.result import load_run
    from eyas.benchmark.statistics.comparison import (
        differences,
        refuse_incomparable,
        text_of,
        verdict,
    )
    from eyas.engine.terminal.ending import print_ending

    (stamp_a, records_a), (stamp_b, records_b) = (
        load_run(folder, trust=trust) for folder in (first, second)
    )
    refuse_incomparable(stamp_a, stamp_b, across_builds=across_builds)
    found = differences(records_a, records_b, stamp_a.plan.rules)
    if json_:
        typer.echo(json.dumps([each._asdict() for each in found], indent=1))
        return
    names = stamp_a.plan.policy, stamp_b.plan.policy
    if names[0] == names[1]:
        names = str(first), str(second)
    for line in verdict(found, names, stamp_a.plan.rules.rank):
        typer.echo(line)
    for name, stamp in (("A", stamp_a), ("B", stamp_b)):
        typer.echo(f"{name}: {stamp.plan.command} (Eyas {stamp.version}, build {stamp.build.id})")
    print_ending(text_of(found), ("rank both on a page", ("eyas", "leaderboard", "page", "FOLDER")))


leaderboard = typer.Typer(help="Rank evaluations, and fly those of others again.")
_Entries = Annotated[
    Path, typer.Argument(metavar="DIR", help="Folder with evaluations, at any depth.")
]


@leaderboard.command()
def page(
    folder: _Entries,
    out: Annotated[Path | None, to_write("The page; by default DIR/index.html.")] = None,
) -> None:
    """Write a page that ranks all evaluations in a folder."""
    from eyas.benchmark.report.leaderboard.page import run

    typer.echo(run(folder, out or folder / "index.html"))


@leaderboard.command()
def pack(
    run: Annotated[Path, typer.Argument(metavar="RUN", help="Folder of a finished evaluation.")],
    out: Annotated[Path | None, to_write("The file; by default RUN.zip.")] = None,
) -> None:
    """Make one file of an evaluation, to be sent in as an entry."""
    from eyas.benchmark.report.leaderboard.pack import pack
    from eyas.engine.terminal.ending import print_ending

    file, made = pack(run, out)
    print_ending(made, ("check it as others will", ("eyas", "leaderboard", "verify", file)))


@leaderboard.command()
def verify(
    folder: Annotated[
        Path,
        typer.Argument(
            metavar="DIR", help="Folder with evaluations, at any depth; or the zip file of one."
        ),
    ],
    share: Annotated[
        float, typer.Option("--share", help="Part of the episodes; at least one batch.")
    ] = 0.1,
    seed: Annotated[
        int | None, typer.Option("--seed", help="Which episodes; by default drawn afresh.")
    ] = None,
    fresh: Annotated[
        int, typer.Option("--fresh", help="Episodes of secret seeds to fly as well.")
    ] = 0,
    trust: Annotated[
        bool, typer.Option("--trust", help="Run the code that entries name or bring.")
    ] = False,
    verdict: Annotated[
        Path | None, typer.Option("--verdict", help="File with what was found, to be signed.")
    ] = None,
) -> None:
    """Fly some episodes of each evaluation again, and mark those whose records are equal.

    The exit code is 1 if the records of one are not those of its flights.
    """
    from eyas.benchmark.report.leaderboard.pack import unpacked
    from eyas.benchmark.report.leaderboard.verify import EntryVerdict, verify, write_verdict

    found = []
    with unpacked(folder) if folder.is_file() else nullcontext(folder) as entries:
        for finding in verify(entries, share=share, seed=seed, fresh=fresh, trust=trust):
            typer.echo(finding.line)
            found.append(finding)
        if verdict is not None:
            write_verdict(verdict, folder, found)
    if EntryVerdict.DIFFERENT in [finding.verdict for finding in found]:
        raise typer.Exit(1)


def reproduce(
    tables: Annotated[
        list[str] | None, typer.Argument(metavar="TABLE", help="Names of tables; none: list them.")
    ] = None,
    out: Annotated[
        Path, to_write("Folder for their evaluations; continued if interrupted.")
    ] = Path("runs/reproduce"),
    row: Annotated[
        str | None, typer.Option("--row", help="Only rows with these words: 'fast downtown'.")
    ] = None,
    share: Annotated[
        float, typer.Option("--share", help="Part of the episodes to fly, for example 0.05.")
    ] = 1.0,
    quiet: Quiet = False,
) -> None:
    """Fly tables of the documents again, and say whether every printed digit is equal.

    Of a part of the episodes it says whether the documents' means lie in the intervals.
    """
    from eyas.benchmark.report.reproduce.run import listing, run

    if not tables:
        typer.echo(listing())
        return
    if not run(tuple(tables), out, row=row, share=share, quiet=quiet):
        raise typer.Exit(1)


policies = typer.Typer(
    help="List the policies that come with Eyas, and show what they reach.", no_args_is_help=True
)


@policies.callback()
def _policies_group() -> None: ...


@policies.command("list")
def list_policies(*, as_json: AsJson = False) -> None:
    """Print the policies for `eyas evaluate --policy`; as JSON, also what trained ones reach."""
    from eyas.benchmark.policies.shipped import card_of, shipped_names
    from eyas.benchmark.policies.table import ABOUT, POLICIES
    from eyas.benchmark.report.reproduce.tables import flown_of

    if as_json:
        listed: list[dict[str, Any]] = [
            {"name": name, "about": ABOUT.get(name)} for name in POLICIES.names()
        ]
        for name in shipped_names():
            figures = [
                {"table": table, **one.model_dump(mode="json"), "build_id": build}
                for table, rows in flown_of(name).items()
                for _, one, build in rows
            ]
            said = card_of(name).model_dump(mode="json")
            listed.append({"name": name, **said, "figures": figures})
        typer.echo(json.dumps(listed, indent=1))
        return
    for name in shipped_names():
        typer.echo(f"{name:<17} trained network: {card_of(name).title}")
    for name in POLICIES.names():
        typer.echo(f"{name:<17} {ABOUT.get(name, POLICIES.path(name))}")
    typer.echo("What a trained network reaches, and how it was trained: eyas policies card NAME")


@policies.command("adapt")
def adapt_policy(
    network: Annotated[Path, typer.Argument(help="An ONNX file of any other tool.")],
    out: Annotated[Path, to_write("File to write: the network, and what it takes.")],
    name: Annotated[
        str | None, typer.Option("--input", help="Name of the input that is the picture.")
    ] = None,
    output: Annotated[
        str | None, typer.Option("--output", help="Name of the output that is the action.")
    ] = None,
    scale: Annotated[
        str | None,
        typer.Option(
            "--scale", help="Numbers of the picture: bytes, unit (0 to 1), signed, imagenet."
        ),
    ] = None,
    swapped: Annotated[
        bool, typer.Option("--swapped", help="Blue comes first, as in OpenCV's pictures.")
    ] = False,
    set_: _Changes = None,
) -> None:
    """Write how a network of others is fed into its file, so that every command can fly it."""
    from eyas.benchmark.policies.foreign import adapt

    said = {"input": name, "output": output, "scale": scale, "swapped": swapped}
    changes = _changes(set_ or [])
    if changes.keys() - {"env"}:
        raise ConfigError("--set: only settings of env belong to a network")
    typer.echo(f"{out}: {adapt(network, out, said, changes.get('env', {}))}")


@policies.command("card")
def policy_card(
    name: Annotated[str, typer.Argument(help="Name of a trained policy: see 'list'.")],
) -> None:
    """Print the model card of a trained policy: what it is for, learned from, reaches, cannot."""
    from eyas.benchmark.policies.shipped import shipped_names
    from eyas.benchmark.report.reproduce.model_card import model_card
    from eyas.engine.core.errors import UnknownNameError

    if name not in shipped_names():
        raise UnknownNameError("NAME", name, shipped_names())
    typer.echo(model_card(name))


@policies.command("push")
def push_policy(
    policy: Annotated[
        str, typer.Argument(help="Name of a trained policy, or the ONNX file of another.")
    ],
    repository: Annotated[
        str, typer.Argument(metavar="NAME", help="ACCOUNT/NAME on the Hugging Face hub.")
    ],
    private: Private = False,
    quiet: Quiet = False,
) -> None:
    """Publish a policy with its model card on the Hugging Face hub."""
    from eyas.benchmark.report.reproduce.hub_card import hub_files, network_of
    from eyas.engine.exports.hub import HubRepository

    network_of(policy)  # before a repository is made
    place = HubRepository(repository, "model", private=private or None)
    place.push(hub_files(policy, place.name), f"Policy {policy}, of Eyas")
    if not quiet:
        typer.echo(place.url)
