"""Products of matrices are those of numpy, but for their last bits."""

from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

from eyas.lanes import exact
from eyas.lanes.elementary import arrays


@pytest.mark.parametrize(
    ("first", "second"),
    [
        ((3,), (3,)),
        ((2, 3), (3,)),
        ((3,), (3, 4)),
        ((2, 3), (3, 4)),
        ((5, 2, 3), (5, 3, 4)),
        ((5, 2, 3), (3, 4)),
        ((1, 0), (0, 3)),  # a sum of nothing
        ((0, 3), (3, 2)),
    ],
)
def test_products_are_those_of_numpy(first, second):
    rng = np.random.default_rng(0)
    a, b = rng.standard_normal(first), rng.standard_normal(second)
    found, expected = exact.product(a, b), a @ b
    assert np.shape(found) == np.shape(expected)
    np.testing.assert_allclose(found, expected, rtol=1e-12, atol=1e-14)


def test_matrices_that_do_not_fit_have_no_product():
    with pytest.raises(ValueError, match=r"shapes \(2, 3\) and \(2, 3\) have no product"):
        exact.product(np.zeros((2, 3)), np.zeros((2, 3)))


NAMES = ("sin", "cos", "tan", "asin", "acos", "atan", "exp", "log", "tanh")


@pytest.mark.parametrize("size", [0, 1, 8, 9, 32, 33, 128, 129, 300])
def test_small_arrays_have_the_bytes_of_large_ones(size):
    x = np.random.default_rng(size).uniform(0.01, 0.99, (300, 2))
    for name in NAMES:
        few, many = getattr(exact, name), getattr(arrays, name)
        assert few(x[:size]).tobytes() == many(x)[:size].tobytes(), name
    assert exact.atan2(x[:size, 0], 0.5).tobytes() == arrays.atan2(x[:, 0], 0.5)[:size].tobytes()
    assert exact.hypot(x[:size], x[:size]).tobytes() == arrays.hypot(x, x)[:size].tobytes()


def test_small_arrays_of_several_threads_do_not_meet():
    x = np.random.default_rng(0).uniform(-9.0, 9.0, (4000, 6))
    with ThreadPoolExecutor(4) as threads:
        found = list(threads.map(exact.sin, x))
    np.testing.assert_array_equal(found, arrays.sin(x))


def test_what_is_returned_for_a_small_array_is_not_written_again():
    first = exact.sin(np.array([0.5]))
    kept = first.copy()
    exact.sin(np.array([1.5]))
    assert first == kept


@pytest.mark.parametrize("kind", [np.float32, np.float64])
def test_cross_products_have_the_bytes_of_numpys(kind):
    a, b = np.random.default_rng(1).normal(size=(2, 40, 5, 3)).astype(kind)
    for first, second in ((a, b), (a[0, 0], b), (a[0, 0], b[0, 0])):
        found = exact.cross(first, second)
        assert (found.dtype, found.tobytes()) == (kind, np.cross(first, second).tobytes())
