"""The parts of the site that are made from the code while it is built: see `docs/conf.py`.

python tools/site_reference.py commands    # prints one of them, as Markdown
"""

import inspect
import json
import re
import sys
from collections.abc import Callable, Iterator
from enum import Enum
from functools import partial
from pathlib import Path
from typing import Any

import eyas
from eyas.engine.core.allowed import describe
from eyas.engine.core.config import Config, entries_of, group_of
from eyas.engine.envs.choice import EnvChoices
from eyas.engine.settings.schema import field_texts

NAMES: dict[str, tuple[str, ...]] = {
    "What the commands do": (
        *("make", "make_vec", "make_config", "record", "load", "export", "evaluate", "track"),
        *("train", "make_dataset", "list_formats", "list_maps", "list_policies", "list_presets"),
        *("list_protocols", "list_targets", "list_weathers"),
    ),
    "Environments": (
        *("TrackingEnv", "EyasVectorEnv", "EyasVecEnv", "EyasParallelEnv", "Observation"),
        *("register_map", "make_lerobot_env", "hover_action", "LegacyObservation"),
    ),
    "Settings": (
        *("Config", "EyasConfig", "SimConfig", "TrackerConfig", "Section", "load_settings"),
        "updated",
    ),
    "Learning": ("Algorithm", "Rollout"),
    "Recordings": (
        *("Recording", "RecordedEpisode", "RecordedFrame", "read_labels", "label_schema"),
        *("Writer", "EpisodeWriter", "Run", "Episode", "Frame", "Files", "Format", "Gather"),
        *("Summary", "FlightScene", "FlightSketch", "write_atomic"),
    ),
    "Policies and trackers": (
        *("Policy", "PolicyInput", "Decision", "Start", "BoxTracker", "Tracker", "protocol_named"),
        *("flown_drone", "towards"),
    ),
    "Rewards and the state": (
        *("RewardTerm", "Snapshot", "TrackerState", "CameraState", "StepResult", "Picture"),
        *("rotate", "rotate_back", "PHYSICS_STEP"),
    ),
    "Sensors": ("Sensor",),
    "Packets and protocols of the wire": (
        *(
            "InputPacket",
            "BasicPacket",
            "RewardPacket",
            "RadarPacket",
            "StepLine",
            "Face",
            "Orders",
        ),
        "serve",
    ),
    "The simulation": ("Simulation", "build_simulation", "together", "each_alone", "kernel"),
    "Targets and meshes": ("ATTRIBUTES", "Ride", "Mesh", "Material", "Shell"),
    "Maps and weathers": (
        *("MapPlan", "MapRecipe", "read_plan", "write_plan", "Survey", "Hills", "Mound"),
        *("Terrain", "RoadEdge", "RoadGraph", "RoadNetwork", "RoadNode", "Scene", "ObjectClass"),
        *("Weather", "Season", "CLEAR_DAY", "DAY"),
    ),
    "Errors": (
        *("EyasError", "ActionError", "ConfigError", "DataFileError", "MissingExtraError"),
        *("OutputError", "SpawnError", "UnknownNameError"),
    ),
}
"""The public names by what they are for."""


def api() -> str:
    """Return a table for each group of public names, which lead to the pages of the groups.

    Raises:
        ValueError: A name is in no group, or one is not public.
    """
    listed = [name for names in NAMES.values() for name in names]
    odd = set(listed) ^ (set(eyas.__all__) - {"__version__", "build_id"})
    if odd:
        raise ValueError(f"tools/site_reference.py: NAMES: {', '.join(sorted(odd))}")
    return "\n\n".join(
        f"## [{title}](api/{page_of(title)}.md)\n\n{_summary(names)}"
        for title, names in NAMES.items()
    )


def page_of(title: str) -> str:
    """Return the name of the page of a group."""
    return title.lower().replace(" ", "-")


def _summary(names: tuple[str, ...]) -> str:
    """Return a table of names, each with the first sentence of its docstring."""
    rows = ["| | |", "|---|---|"]
    for name in names:
        value = getattr(eyas, name)
        about = (inspect.getdoc(value) or "") if callable(value) else ""  # else of its type
        first = " ".join(about.split("\n\n")[0].split()).partition(". ")[0].rstrip(".")
        rows.append(f"| {{py:obj}}`~eyas.{name}` | {_sentence(first)} |")
    return "\n".join(rows)


def _sentence(text: str) -> str:
    """Return a sentence of a docstring as Markdown: code stays code."""
    parts = text.split("`")
    return "`".join(part if i % 2 else _plain(part) for i, part in enumerate(parts))


def _directives(names: tuple[str, ...]) -> str:
    """Return the directives that document names from their docstrings."""
    kinds = {name: "data" if name.isupper() else "function" for name in names}
    kinds |= {name: "class" for name in names if isinstance(getattr(eyas, name), type)}
    kinds |= {name: "data" for name in names if not callable(getattr(eyas, name))}
    lines = [f".. auto{kinds[name]}:: eyas.{name}{_with_choices(name)}\n" for name in names]
    return "```{eval-rst}\n" + "\n".join(lines) + "```"


def _with_choices(name: str) -> str:
    """Return the signature of what takes `**choices`, with their names; "" of all else."""
    value = getattr(eyas, name)
    try:
        given = inspect.signature(value).parameters
    except (TypeError, ValueError):
        return ""
    if "choices" not in given:
        return ""
    words, named = [], False
    for each in given.values():
        named = named or each.kind is each.KEYWORD_ONLY
        if each.name == "choices":
            words += [] if named else ["*"]
            words += [f"{key}=..." for key in EnvChoices.__annotations__]
        else:
            words += ["*"] if each.kind is each.KEYWORD_ONLY and "*" not in words else []
            shown = str(each.default) if isinstance(each.default, Enum) else repr(each.default)
            words.append(each.name if each.default is each.empty else f"{each.name}={shown}")
    return f"({', '.join(words)})"


def commands() -> str:
    """Return a section for each command of `eyas`, with its arguments and options."""
    import typer

    from eyas.cli.app import app
    from eyas.cli.completion import commands as all_commands

    every = sorted(all_commands("eyas", typer.main.get_command(app)), key=lambda one: one[0])
    return "\n\n".join(_command(path, one) for path, one in every if not hasattr(one, "commands"))


def _command(path: str, command: Any) -> str:  # noqa: ANN401  # click's
    help_ = " ".join((command.help or "").split())
    rows = [row for each in command.params if (row := _parameter(each))]
    arguments = "".join(f" {_place(each)}" for each in command.params if _is_place(each))
    usage = f"```text\n{path}{arguments}{' [OPTIONS]' if len(rows) else ''}\n```"
    table = ["| | | default |", "|---|---|---|", *rows] if rows else []
    return f"## {path}\n\n{_plain(help_)}\n\n{usage}\n\n" + "\n".join(table)


def _is_place(parameter: Any) -> bool:  # noqa: ANN401
    return bool(parameter.param_type_name == "argument")


def _place(parameter: Any) -> str:  # noqa: ANN401
    name = (parameter.metavar or parameter.name).upper()
    return name if parameter.required else f"[{name}]"


def _parameter(parameter: Any) -> str:  # noqa: ANN401
    if getattr(parameter, "hidden", False) or parameter.name == "help":
        return ""
    if _is_place(parameter):
        name = f"`{_place(parameter)}`"
    else:
        words = parameter.opts + parameter.secondary_opts
        name = ", ".join(f"`{word}`" for word in words)
        name += _kind(parameter)
    default = parameter.default
    said = "" if default in (None, False, ()) or parameter.required else f"`{default}`"
    if parameter.required:
        said = "*needed*"
    return f"| {name} | {_plain(parameter.help or '')} | {said} |"


def _kind(parameter: Any) -> str:  # noqa: ANN401
    """Return what an option takes, in capitals; nothing if it is a switch."""
    described = getattr(parameter, "type_descriptor", None)  # of Typer's own copy of click
    annotation = described.annotation if described else None
    if parameter.is_flag or annotation is bool:
        return ""
    if parameter.metavar:
        return f" {parameter.metavar}"
    said = getattr(annotation, "__name__", "text") if described else parameter.type.name
    return " " + {"str": "TEXT", "int": "INTEGER", "float": "NUMBER"}.get(said, said.upper())


def _plain(text: str) -> str:
    """Return a text in which Markdown finds no markup of its own."""
    return re.sub(r"([|*_<>\[\]])", r"\\\1", text)


def settings() -> str:
    """Return a table for each group of settings: default, what is allowed, unit, meaning.

    It stands in `docs/reference/settings.md`, where `tools/write_docs.py` writes it.
    """
    from eyas.engine.settings.config import EyasConfig

    return "\n\n".join(_group("", EyasConfig))


def _group(path: str, group: type[Config]) -> Iterator[str]:
    """Yield the table of a group, then those of the groups in it."""
    texts = field_texts(group)
    rows, below = [], []
    for name, field in group.model_fields.items():
        key = f"{path}{name}"
        inner, entries = group_of(field), entries_of(field)
        if inner is not None and "[]" not in path:  # in a list, as described above
            below.append((f"{key}.", inner))
        if entries is not None:
            below.append((f"{key}[].", entries))
        if (f"{key}.", inner) in below and isinstance(field.default, Config):
            continue
        rows.append(_setting(key, field, texts.get(name, "")))
    title = f"`{path.rstrip('.')}`" if path else "The run"
    about = " ".join((group.__doc__ or "").split("\n\n")[0].split())
    head = ["| setting | default | allowed | unit | meaning |", "|---|---|---|---|---|"]
    if rows:
        yield f"## {title}\n\n{about if path else ''}\n\n" + "\n".join([*head, *rows])
    for inner_path, one in below:
        yield from _group(inner_path, one)


UNIT = re.compile(
    r"\[((?:m|s|h|rad|kg|Hz|K|lx|N|V|A|px|pixels|ms|us|1|°)[^\]\d]{0,8}[\^²³\d]*[^\]]{0,6})\]"
)
"""A unit in square brackets, as docstrings have it."""


def _setting(key: str, field: Any, text: str) -> str:  # noqa: ANN401  # pydantic's
    units = UNIT.findall(text)
    standard = field.get_default(call_default_factory=True)
    default = "*needed*" if field.is_required() else f"`{json.dumps(_json(standard))}`"
    allowed = describe(field.annotation, field.metadata)
    for power in (31, 63):
        allowed = allowed.replace(str(2**power), f"2^{power}")
    cells = (f"`{key}`", default, _plain(allowed), _plain(units[0] if units else ""))
    text = re.sub(r"\bdocs/([\w/-]+)\.md", r"[\1](../\1.md)", text.replace("|", r"\|"))
    return f"| {' | '.join(cells)} | {text} |"


def _json(value: object) -> object:
    if isinstance(value, Config):
        return value.model_dump(mode="json")
    if isinstance(value, tuple):
        return [_json(part) for part in value]
    return getattr(value, "value", value)


def history() -> str:
    """Return the speed of earlier commits, as `bench/history.py` has recorded it."""
    bench = Path(__file__).parents[1] / "bench"
    sys.path.insert(0, str(bench))
    from history import page

    return str(page(bench / "history"))


MADE: dict[str, Callable[[], str]] = {
    "api": api,
    **{f"api/{page_of(title)}": partial(_directives, names) for title, names in NAMES.items()},
    "commands": commands,
    "history": history,
}
"""What a page gets in the place of `<!-- site: NAME -->`."""

if __name__ == "__main__":
    print(MADE[sys.argv[1]]())
