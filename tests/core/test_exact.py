"""Products of matrices are those of numpy, but for their last bits."""

import numpy as np
import pytest

from eyas.core import exact


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
