"""Location of SUMO: the optional packages of the extra `sumo`, imported only when needed."""

import importlib
import os
import sys
from contextlib import redirect_stdout
from importlib.metadata import PackageNotFoundError, version
from io import StringIO
from pathlib import Path
from types import ModuleType

from eyas.engine.core.errors import MissingExtraError

SYSTEM_PACKAGES = "libgl1 libx11-6 libxext6 libxrender1 libexpat1 libatomic1"
"""Packages of Debian and Ubuntu that SUMO's wheels need."""


def sumo_binary(name: str) -> Path:
    """Return the path of one of SUMO's programs, for example `netconvert`.

    Raises:
        MissingExtraError: SUMO is not installed.
    """
    path = _home() / "bin" / (f"{name}.exe" if sys.platform == "win32" else name)
    if not path.exists():
        raise missing_sumo(name)
    return path


def sumo_environment() -> dict[str, str]:
    """Return the environment that SUMO's programs need when called by path.

    Raises:
        MissingExtraError: SUMO is not installed.
    """
    home = _home()
    return {**os.environ, "SUMO_HOME": str(home), "PROJ_LIB": str(home / "data" / "proj")}


def import_libsumo() -> ModuleType:
    """Return the module that runs SUMO in this process.

    Raises:
        MissingExtraError: SUMO, or a system library it needs, is not installed.
    """
    os.environ.setdefault("SUMO_HOME", str(_home()))
    with redirect_stdout(StringIO()):  # it prints advice about pyarrow, which nothing here uses
        return _imported("libsumo")


def sumo_version(
    purpose: str = "traffic",  # The feature that needs it, as a noun phrase for the error
) -> str:
    """Return the installed version of SUMO, for example `1.28.0`.

    Raises:
        MissingExtraError: SUMO is not installed.
    """
    try:
        return version("eclipse-sumo")
    except PackageNotFoundError:
        raise missing_sumo(purpose) from None


def missing_sumo(purpose: str) -> MissingExtraError:
    """Return the error that explains how to install SUMO."""
    return MissingExtraError(
        purpose, "sumo", f"(on Debian or Ubuntu also: apt-get install {SYSTEM_PACKAGES})"
    )


def _home() -> Path:
    return Path(str(_imported("sumo").SUMO_HOME))


def _imported(name: str) -> ModuleType:
    try:
        return importlib.import_module(name)
    except ImportError:  # also raised if a system library is missing
        raise missing_sumo("traffic") from None
