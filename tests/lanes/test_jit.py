"""Kernels made of other kernels, and how they are kept on disk."""

import dis
import importlib
import inspect
import json
import os
import pkgutil
import subprocess
import sys
import types

import pytest

import eyas
from eyas.engine.sim.step import step_of
from eyas.engine.trackers.drone import DRONE
from eyas.engine.trackers.tracker import Tracker
from eyas.lanes import Kernel, kernel, specialised


@kernel
def doubled(x):
    return 2.0 * x


@kernel
def tripled(x):
    return 3.0 * x


def applied(x):
    return doubled(x) + 0.5


def test_a_specialised_function_calls_the_other_kernel_and_leaves_the_first_as_it_is():
    other = specialised(applied, doubled=tripled)
    assert other(2.0) == kernel(other)(2.0) == 6.5
    assert applied(2.0) == kernel(applied)(2.0) == 4.5


def test_with_the_kernels_that_it_names_a_function_stays_itself():
    assert specialised(applied, doubled=doubled) is applied
    assert step_of(DRONE) is step_of(DRONE)


def test_the_same_kernels_give_the_same_name_and_others_another():
    names = [
        specialised(applied, doubled=other).__qualname__
        for other in (tripled, tripled, kernel(abs_))
    ]
    assert names[0] == names[1] != names[2]
    assert all(name.startswith("applied_") for name in names)


def abs_(x):
    return abs(x)


OWN = """
from eyas.lanes import kernel

@kernel
def first(x):
    return 2.0 * x

@kernel
def other(x):
    return FACTOR * x
"""
SPECIALISED = """
import json, sys
import numpy as np
from eyas.lanes import compiled, specialised
from eyas.lanes.folder import kernel_folder
from function import write
from own import other
made = compiled(specialised(write, first=other))
out = np.zeros(1)
made(2.0, out)
files = kernel_folder().glob("write_*")
print(json.dumps([out[0], len(list(files)), "numba" in sys.modules]))
"""


@pytest.fixture
def run(tmp_path):
    """Run a program with a cache of its own; return what it prints."""

    def program(text, *folders):
        path = os.pathsep.join([*map(str, folders), *filter(None, sys.path)])
        settings = {"NUMBA_CACHE_DIR": str(tmp_path / "cache"), "PYTHONPATH": path}
        done = subprocess.run(
            [sys.executable, "-c", text],
            capture_output=True, text=True, check=False, env={**os.environ, **settings},
        )  # fmt: skip
        assert not done.returncode, done.stderr
        return json.loads(done.stdout)

    return program


@pytest.mark.slow
def test_processes_share_what_was_compiled_until_the_source_of_a_kernel_changes(run, tmp_path):
    """And who finds all compiled does without numba, whose import takes half a second."""
    (tmp_path / "function.py").write_text(
        "from own import first\n\ndef write(x, out):\n    out[0] = first(x)\n"
    )
    own = tmp_path / "own.py"
    own.write_text(OWN.replace("FACTOR", "3.0"))
    assert run(SPECIALISED, tmp_path) == [6.0, 1, True]
    assert run(SPECIALISED, tmp_path) == [6.0, 1, False]
    own.write_text(OWN.replace("FACTOR", "5.00"))  # Python tells files by second and size
    assert run(SPECIALISED, tmp_path) == [10.0, 2, True]


DRIVERS = ("eyas.gpu.sim.", "eyas.gpu.envs.", "eyas.gpu.render.stages")
"""Rooms of functions that become kernels of a device only when they are launched."""


def test_eyas_itself_calls_no_kernel_from_python():
    """Which would import numba and compile it at every start."""
    modules = [
        importlib.import_module(info.name)
        for info in pkgutil.walk_packages(eyas.__path__, "eyas.")
        if not info.name.startswith(("eyas.engine.core.", "eyas.engine.traffic.sumo", *DRIVERS))
    ]
    functions = [function for module in modules for function in functions_of(module)]
    assert len(functions) > 500
    compiled = {call.function.__code__ for call in step_of(DRONE)[:3]}
    compiled |= {code for module in modules for code in specialised_in(module)}
    for function in functions:
        hands_on = function.__annotations__.get("return") is Tracker
        hands_on |= function.__qualname__.endswith("Rig.__init__")  # to devices
        if function.__code__ not in compiled and not hands_on:
            loads = [each for each in dis.get_instructions(function) if "GLOBAL" in each.opname]
            used = (function.__globals__.get(each.argval) for each in loads)
            called = [kernel.__name__ for kernel in used if isinstance(kernel, Kernel)]
            assert not called, f"{function.__module__}.{function.__qualname__} calls {called}"


def specialised_in(module):
    """Yield the code of functions that make kernels of others, and of those."""
    values = [getattr(value, "__wrapped__", value) for value in vars(module).values()]
    for maker in (value for value in values if isinstance(value, types.FunctionType)):
        if "specialised" in maker.__code__.co_names:
            yield maker.__code__
            named = [maker.__globals__.get(name) for name in maker.__code__.co_names]
            yield from (base.__code__ for base in named if isinstance(base, types.FunctionType))


def functions_of(module):
    for value in vars(module).values():
        if getattr(value, "__module__", None) != module.__name__:
            continue
        members = vars(value).values() if inspect.isclass(value) else (value,)
        for member in members:
            function = getattr(member, "fget", getattr(member, "__func__", member))
            if isinstance(function, types.FunctionType):
                yield function
