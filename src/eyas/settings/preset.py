"""Settings that come with Eyas, by name."""

from importlib.resources import files
from pathlib import Path

from eyas.core.errors import UnknownNameError

__all__ = ["PRESETS", "preset_file"]

PRESETS = (
    *("dat-eval", "dat-train", "easy", "lively", "noisy"),
    *("anywhere", "fast", "long", "paper", "robust"),
)
"""Names of all presets; docs/configuration.md says what each is for."""


def preset_file(name: str) -> Path:
    """Return the file of a preset.

    Raises:
        UnknownNameError: There is no such preset.
    """
    if name not in PRESETS:
        raise UnknownNameError("preset", name, PRESETS)
    return Path(str(files("eyas.settings"))) / "presets" / f"{name}.json"
