"""Settings that come with Eyas, by name."""

from importlib.resources import files
from pathlib import Path

from eyas.engine.core.errors import UnknownNameError

__all__ = ["DAT_MODES", "PRESETS", "TRAININGS", "WORLDS", "preset_file"]

DAT_MODES = ("dat-eval", "dat-train")
"""The modes of the DAT benchmark."""

WORLDS = ("easy", "flown", "lively", "noisy")
"""Worlds that are easier or harder than the default; in one, a flight controller flies."""

TRAININGS = ("eyas", "eyas-words", "fast", "paper")
"""How the policies that come with Eyas were trained, and a published training."""

PRESETS = (*DAT_MODES, *WORLDS, *TRAININGS)
"""Names of all presets; docs/configuration.md says what each is for."""


def preset_file(name: str) -> Path:
    """Return the file of a preset.

    Raises:
        UnknownNameError: There is no such preset.
    """
    if name not in PRESETS:
        raise UnknownNameError("preset", name, PRESETS)
    return Path(str(files("eyas.engine.settings"))) / "presets" / f"{name}.json"
