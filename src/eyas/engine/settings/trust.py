"""Trust in files of settings: only those that the user trusts may name code.

Settings name code by `package.module:attribute`: terms of the reward, targets, trackers, maps and
writers of one's own. Importing and calling these is as good as running a program of whoever wrote
the settings. So a file may do it only if the user says so; what is given on the command line, or
from Python as an object, is the user's own.
"""

import os
from collections.abc import Collection, Iterator
from pathlib import Path

from eyas.engine.core.errors import ConfigError
from eyas.engine.core.files import user_path
from eyas.engine.core.named_code import code_named
from eyas.engine.settings.config import EyasConfig, variants

TRUST_VARIABLE = "EYAS_TRUST"
"""Environment variable: folders whose files of settings, at any depth, may name code."""


def code_of(config: EyasConfig) -> Iterator[tuple[str, str]]:
    """Yield each piece of code that settings name, as `eyas.engine.core.named_code.code_named`.

    Those of mixtures and stages are included, where they differ from the common ones.
    """
    common = tuple(code_named(config))
    yield from common
    known = {name for _, name in common}
    for path, variant in variants(config):
        for setting, name in code_of(variant):
            if name not in known:
                yield f"{path}.{setting}", name


def is_trusted(path: Path) -> bool:
    """Return whether a file lies in a folder of `EYAS_TRUST`, links followed.

    Raises:
        EyasError: A folder there is relative, or of no user.
    """
    named = os.environ.get(TRUST_VARIABLE, "").split(os.pathsep)
    folders = [user_path(text) for text in named if text]
    for folder in folders:
        if not folder.is_absolute():  # it would be wherever the user happens to be
            raise ConfigError(f"{TRUST_VARIABLE}: '{folder}' is not allowed: absolute folders")
    return any(path.resolve().is_relative_to(folder.resolve()) for folder in folders)


def refuse_code(path: Path, config: EyasConfig, typed: Collection[str] = ()) -> None:
    """Refuse code that only a file names.

    Args:
        path: The file.
        config: The settings that it has led to.
        typed: Texts that the user has typed beside it; code that is named there is the user's.

    Raises:
        ConfigError: It names code, and is not trusted: one line with all that would run.
    """
    refuse_named(path, [(setting, name) for setting, name in code_of(config) if name not in typed])


def refuse_named(path: Path, code: Collection[tuple[str, str]]) -> None:
    """Refuse code that a file names: each piece with the path of its setting.

    Raises:
        ConfigError: There is some, and the file is not trusted.
    """
    names = [f"{name!r} ({setting})" for setting, name in code]
    if names and not is_trusted(path):
        raise ConfigError(
            f"{path}: this file would run code: {', '.join(names)}; if you trust whoever wrote it, "
            f"say --trust (in Python load_settings(..., trust=True)), name the code with --set, or "
            f"put the file's folder into {TRUST_VARIABLE}"
        )
