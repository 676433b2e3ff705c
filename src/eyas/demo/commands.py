"""`eyas demo` and `eyas replay`."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from eyas.engine.core.errors import ConfigError
from eyas.engine.terminal.ending import print_ending
from eyas.engine.terminal.options import (
    ConfigFile,
    MapName,
    Overrides,
    Preset,
    Rerun,
    RerunAt,
    Seed,
    Trust,
    Weather,
    by_policy,
    chosen_file,
    gathered,
    to_write,
)

if TYPE_CHECKING:
    from eyas.benchmark.plan.plan import EvaluationPlan


def demo(
    config: ConfigFile = None,
    preset: Preset = None,
    map_name: MapName = None,
    weather: Weather = None,
    seed: Seed = None,
    set_: Overrides = None,
    trust: Trust = False,
    policy: Annotated[str | None, by_policy("A policy that may fly, too: ")] = None,
    host: Annotated[
        str, typer.Option("--host", help="Address to serve; others than loopback ask for a token.")
    ] = "127.0.0.1",
    port: Annotated[
        int, typer.Option("--port", min=0, max=65535, help="Port to serve; 0: any.")
    ] = 8720,
    browser: Annotated[
        bool, typer.Option("--browser/--no-browser", help="Open the page in a browser.")
    ] = True,
    headless: Annotated[
        bool, typer.Option("--headless", help="Print the reward of a hovering drone instead.")
    ] = False,
    seconds: Annotated[
        float | None,
        typer.Option("--seconds", min=0.1, help="Stop after this time, with --headless."),
    ] = None,
    rerun: Rerun = False,
    rerun_at: RerunAt = None,
    record_for: Annotated[
        str | None,
        typer.Option(
            "--record-for",
            metavar="PROTOCOL",
            help="Record flights of people in a protocol, for a leaderboard: each episode once.",
        ),
    ] = None,
    out: Annotated[
        Path | None, to_write("Folder of --record-for; by default runs/people-PROTOCOL.")
    ] = None,
    episodes: Annotated[
        int | None,
        typer.Option(
            "--episodes", help="With --record-for: for each map, weather, target and direction."
        ),
    ] = None,
) -> None:
    """Fly a drone by keyboard through any map, in the browser, and watch the reward."""
    from eyas.engine.settings.file import load_settings

    if seconds is not None and not headless:
        raise ConfigError("--seconds: only with --headless")
    if record_for is not None:
        others = {
            **{"--config": config, "--preset": preset, "--set": set_, "--policy": policy},
            **{"--headless": headless, "--rerun": rerun, "--rerun-at": rerun_at},
        }
        for name, value in others.items():
            if value:
                raise ConfigError(f"{name}: not together with --record-for: the protocol decides")
        plan = _to_record(record_for, out, map_name, weather, seed, episodes)
        _record(plan, host, port, browser=browser)
        return
    if out is not None or episodes is not None:
        raise ConfigError("--out, --episodes: only with --record-for")
    overrides = gathered(set_, map_name, weather, seed)
    settings = load_settings(chosen_file(config, preset), overrides, trust=trust)
    if config is not None:
        from eyas.engine.settings.dialect import of_a_run

        settings = of_a_run(settings)
    from eyas.demo import run as demo  # after all checks
    from eyas.engine.recordings.rerun import live_view

    listening = None if headless else demo.listen(host, port)
    with live_view(wanted=rerun, at=rerun_at) as live:
        session = demo.session_of(settings, policy, live)
        if listening is None:
            demo.run_headless(session, seconds or 10.0, typer.echo)
        else:
            stage = demo.free_flight(session)
            demo.run_browser(stage, host, listening, browser=browser, say=typer.echo)


def _to_record(
    protocol: str,
    out: Path | None,
    map_name: str | None,
    weather: str | None,
    seed: int | None,
    episodes: int | None,
) -> "EvaluationPlan":
    """Return the plan of flights of people."""
    from eyas.demo.reference import plan_for

    choices: dict[str, Any] = {
        **({"maps": (map_name,)} if map_name is not None else {}),
        **({"weathers": (weather,)} if weather is not None else {}),
        **({"seeds": (seed,)} if seed is not None else {}),
        "episodes": episodes,
    }
    return plan_for(protocol, out or Path("runs") / f"people-{protocol}", **choices)


def _record(plan: "EvaluationPlan", host: str, port: int, *, browser: bool) -> None:
    """Let people fly a plan, and say where their flights are."""
    from eyas.demo import run as demo
    from eyas.demo.stages import ReferenceStage

    listening = demo.listen(host, port)
    demo.run_browser(ReferenceStage(plan), host, listening, browser=browser, say=typer.echo)
    folder = Path(plan.policy).parent
    print_ending(
        f"{plan.count} flights in {folder}",
        ("make an entry for a leaderboard", ("eyas", "leaderboard", "pack", folder)),
    )


def replay(
    link: Annotated[
        str, typer.Argument(help="Link of a film, as the demo's page makes it, or its address.")
    ],
    out: Annotated[
        Path | None, to_write("Folder to record it into, as eyas video does; by default nowhere.")
    ] = None,
    seconds: Annotated[
        float, typer.Option("--seconds", min=0.04, max=60.0, help="How much of it.")
    ] = 60.0,
) -> None:
    """Fly the film of a link again, with the same bytes, and print their digest."""
    from eyas.demo.film import SIZE, flown, read_link
    from eyas.demo.offer import Offer
    from eyas.engine.settings.config import EyasConfig

    film = flown(read_link(link, Offer.of(EyasConfig())), seconds, out)
    said = f"{film.pictures} pictures of {SIZE[0]} x {SIZE[1]}, digest {film.digest}"
    if out is None:
        print_ending(said, ("record it", ("eyas", "replay", link, "--out", "FOLDER")))
    else:
        print_ending(f"{said}, in {out}", ("see it", ("eyas", "open", out)))
