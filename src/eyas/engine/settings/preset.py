"""Settings that come with Eyas, by name. Light: the help of commands names them."""

from importlib.resources import files
from pathlib import Path

from eyas.engine.core.doors import brought
from eyas.engine.core.errors import UnknownNameError

PRESETS = {
    **{name: f"{__package__}:presets/{name}.json" for name in ("easy", "flown", "lively", "noisy")},
    **brought("eyas.presets"),
}
"""Files of all presets, `package:path`; docs/configuration.md says what each is for. The engine's
own are worlds that are easier or harder than the default; in one, a flight controller flies."""


def preset_file(name: str) -> Path:
    """Return the file of a preset.

    Raises:
        UnknownNameError: There is no such preset.
    """
    if name not in PRESETS:
        raise UnknownNameError("preset", name, tuple(PRESETS))
    package, _, path = PRESETS[name].partition(":")
    return Path(str(files(package))) / path
