"""`eyas demo`."""

from typing import Annotated

import typer

from eyas.engine.core.errors import ConfigError
from eyas.engine.terminal.options import (
    ConfigFile,
    MapName,
    Overrides,
    Preset,
    Seed,
    Trust,
    Weather,
    by_policy,
    chosen_file,
    gathered,
)


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
) -> None:
    """Fly a drone by keyboard through any map, in the browser, and watch the reward."""
    from eyas.engine.settings.file import load_settings

    if seconds is not None and not headless:
        raise ConfigError("--seconds: only with --headless")
    overrides = gathered(set_, map_name, weather, seed)
    settings = load_settings(chosen_file(config, preset), overrides, trust=trust)
    if config is not None:
        from eyas.engine.settings.dialect import of_a_run

        settings = of_a_run(settings)
    from eyas.demo import run as demo  # after all checks

    listening = None if headless else demo.listen(host, port)
    session = demo.session_of(settings, policy)
    if listening is None:
        demo.run_headless(session, seconds or 10.0, typer.echo)
    else:
        demo.run_browser(session, host, listening, browser=browser, say=typer.echo)
