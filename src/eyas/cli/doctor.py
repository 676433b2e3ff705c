"""`eyas doctor`: what Eyas finds on this machine."""

import json
import os
import platform
import re
import sys
from importlib.metadata import PackageNotFoundError, requires, version
from importlib.util import find_spec

import numpy as np

from eyas.engine.core.errors import EyasError
from eyas.engine.core.installed import installed_version
from eyas.engine.core.machine import describe_machine
from eyas.engine.render.kernels.draw import draw_views
from eyas.gpu.cuda import gpu_line
from eyas.lanes import thread_count
from eyas.lanes.entry import EXTRA
from eyas.lanes.folder import refusal
from eyas.lanes.identity import code_name
from eyas.lanes.shipped import LEVELS, WIDE, KernelLibrary, draws_wide, is_shipped, misfit
from eyas.lanes.trusted import FOLDER_VARIABLE, cache_folder

_NEEDED = ("numpy",)
_EXTRAS = ("numba", "llvmlite", "torch", "onnxruntime")
_EXTRA = re.compile(r"([\w.-]+)[^;]*;.*\bextra == ['\"]([\w-]+)['\"].*")
"""A requirement of an extra: package and extra."""
_PYTHON = re.compile(r"\bpython_version (<|>=) ['\"]3\.(\d+)['\"]")
"""Which Pythons a requirement is for, if not for all."""
_FOR_DEVELOPERS = ("dev", "docs", "peers", "release")


def run(*, as_json: bool = False) -> None:
    """Print what is found."""
    found = facts() | {"a picture": _picture()}
    if as_json:
        print(json.dumps(found, indent=2))
        return
    for name, text in found.items():
        print(f"{name + ':':<17} {text}")


def facts() -> dict[str, str]:
    """Return what is found, by names for people."""
    packages = [f"{name} {_version(name)}" for name in _NEEDED]
    packages += [f"{name} {_version(name)}" for name in _EXTRAS if find_spec(name) is not None]
    return {
        "Eyas": installed_version(),
        "Python": f"{platform.python_version()} ({platform.python_implementation()})",
        "packages": ", ".join(packages),
        "machine": describe_machine(),
        "threads": str(thread_count()),
        "cache": _cache(),
        "shipped kernels": _shipped(),
        "graphics card": gpu_line(),
        "extras": _lacking(),
    }


def _lacking() -> str:
    """Return which extras are not whole, and what they lack."""
    lacking: dict[str, list[str]] = {}
    for line in _requirements():
        found = _EXTRA.fullmatch(line)
        if not found or not _of_this_python(line):
            continue
        if found[2] not in _FOR_DEVELOPERS and _version(found[1]) == "missing":
            lacking.setdefault(found[2], []).append(found[1])
    if not lacking:
        return "all are whole"
    return "; ".join(f"{extra} lacks {', '.join(names)}" for extra, names in lacking.items())


def _of_this_python(requirement: str) -> bool:
    found = _PYTHON.search(requirement)
    older = found is not None and sys.version_info[1] < int(found[2])
    return found is None or older == (found[1] == "<")


def _requirements() -> list[str]:
    try:
        return requires("eyas") or []
    except PackageNotFoundError:  # run from a folder that is not installed
        return []


def _picture() -> str:
    """Draw a picture of the default settings, and return how that went."""
    from eyas.engine.api import make

    try:
        env = make(render_mode="rgb_array")
        env.reset(seed=0)
        height, width, _ = np.asarray(env.render()).shape
        env.close()
    except (EyasError, OSError) as error:
        return f"cannot be drawn: {error}"
    return f"drawn, {width}x{height} pixels"


def _version(package: str) -> str:
    try:
        return version(package)
    except PackageNotFoundError:
        return "missing"


def _cache() -> str:
    """Return where the cache is, or why compiled kernels are not kept."""
    moved = f" (by {FOLDER_VARIABLE})" if FOLDER_VARIABLE in os.environ else ""
    reason = refusal()
    said = f"{cache_folder()}{moved}"
    return f"{said}; compiled kernels are not kept: {reason}" if reason else said


def _shipped() -> str:
    """Return whether kernels that come compiled serve this machine, or why not."""
    compiles = find_spec("numba") is not None
    compiled = "kernels are compiled at the first start"
    if not compiles:
        compiled = f"kernels cannot be compiled without: pip install 'eyas[{EXTRA}]'"
    if why := misfit():
        return f"{why}: {compiled}"
    level = LEVELS[platform.machine()]
    try:
        kernels = len(KernelLibrary.opened(level.library).names)
    except (OSError, ValueError) as error:
        return f"{level.library}: damaged or missing ({error}): {compiled}"
    drawn = f" (what draws: {WIDE.name})" if draws_wide() else ""
    said = f"{kernels} for {level.name}{drawn}, which serve this machine"
    if not is_shipped(code_name(draw_views.function)):
        return f"{said}, but what draws has changed since: {compiled}"
    more = "kernels of your own and rare settings are compiled" if compiles else compiled
    return f"{said}; {more}"
