"""What kernels need of numba; if a new version of numba changes that, these tests fail."""

import math
from functools import cache

import numba
import numpy as np
import pytest
from numba.core.registry import cpu_target
from numba.core.typing import Context

from eyas.lanes import compilation, compiled, front_end, kernel
from eyas.lanes.compilation import entry_code
from eyas.lanes.machine_code import load


@kernel
def scaled(x, factor, power=2):
    return factor * x**power


@kernel(inline=True)
def shifted(x, by):
    return scaled(x + by, factor=2.0)


@kernel
def counted(n):
    return n // 3


def call(function, *values) -> list[float]:
    """Return what a function of one array writes into it, called from a kernel."""

    def work(values):
        function(values)

    array = np.array(values, np.float64)
    compiled(work)(array)
    return array.tolist()


def test_kernels_call_kernels_with_defaults_and_names():
    @kernel
    def work(a):
        a[0] = shifted(a[0], 1.0)
        a[1] = scaled(power=3, x=a[1], factor=0.5)

    assert call(work, 2.0, 2.0) == [18.0, 4.0]
    assert shifted(2.0, 1.0) == 18.0  # from Python


def test_functions_of_numba_are_linked_too():
    """Those that numba compiles for itself, and those of the C library."""

    @kernel
    def work(a):
        a[0] = math.hypot(a[0], 4.0) + math.sin(0.0)
        a[1] = max(a[1:3]) + np.sum(a[1:3]) + 7 % 4
        a[2] = (-7) // 2 + math.floor(2.5) + round(3.4) + int(a[2]) ** 3

    assert call(work, 3.0, 1.0, 2.0) == [5.0, 8.0, 9.0]


def test_a_kernel_is_compiled_once_for_all_signed_whole_numbers(tmp_path, monkeypatch):
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))  # or it might not be compiled at all

    @kernel
    def work(a):
        wide = len(a)
        a[0] = counted(7) + counted(wide) + counted(np.int32(9)) + counted(np.int8(6))

    assert call(work, 1.0) == [7.0]
    assert len(counted._numba_type_.get_call_signatures()[0]) == 1


def test_only_a_kernel_as_a_whole_becomes_machine_code(monkeypatch):
    """Its functions do not: that took most of the time of compiling."""
    made, finalised = [], []
    before = compilation.optimised
    monkeypatch.setattr(compilation, "optimised", lambda *a: made.append(a) or before(*a))
    engine = cpu_target.target_context.codegen()
    monkeypatch.setattr(engine, "_add_module", finalised.append)

    @kernel
    def work(a):
        a[0] = shifted(a[0], 2.0)

    assert call(work, 1.0) == [18.0]
    assert len(made) == 1
    assert not finalised


def test_a_kernel_that_raises_says_so():
    @kernel
    def work(a):
        if a[0] > 0.0:
            raise ValueError("too large")

    assert call(work, 0.0) == [0.0]
    with pytest.raises(RuntimeError, match="kernel raised"):
        call(work, 1.0)


def test_kernels_divide_by_zero_as_numpy_does_and_count_no_references():
    @kernel
    def work(a):
        a[0] = a[0] / a[1]

    assert call(work, 1.0, 0.0)[0] == math.inf

    def passed_on(values):
        work(values[1:])

    code = entry_code(passed_on, [numba.typeof(np.ones(2))], "passed_on", over_workers=False)
    assert code.needs == ()
    assert load(code)


def test_functions_of_users_call_kernels():
    assert numba.njit(lambda x: shifted(x, 1.0))(2.0) == 18.0


def test_products_and_sums_are_rounded_one_by_one():
    """No CPU may fuse them, or pictures would differ between CPUs."""

    @kernel
    def work(a):
        a[0] = a[0] * a[1] - a[2]

    x = 1.0 + 2.0**-30
    assert call(work, x, x, 1.0 + 2.0**-29)[0] == x * x - (1.0 + 2.0**-29) == 0.0


def test_the_rules_for_an_operator_are_tried_once_for_the_same_types(monkeypatch):
    asked, before = [], Context.resolve_function_type

    def noted(self, function, kinds, names):
        if isinstance(function, numba.types.Function) and not names:
            asked.append((id(function), kinds))
        return before(self, function, kinds, names)

    @kernel
    def other(x):
        return x * 2.0 - 1.0

    @kernel
    def work(a):
        a[0] = other(a[0]) * 2.0 - 1.0
        a[1] = other(a[1]) * 2.0 - 1.0

    monkeypatch.setattr(Context, "resolve_function_type", noted)
    monkeypatch.setattr(front_end, "typing", cache(front_end.typing.__wrapped__))
    monkeypatch.setattr(compilation, "typing", front_end.typing)
    assert call(work, 1.0, 2.0) == [1.0, 5.0]
    assert len(asked) == len(set(asked)) > 0
