"""Random numbers by their number."""

import math

from eyas.engine.core import counter_rng
from eyas.lanes import interpreted

mixed, uniform, normal = map(
    interpreted, (counter_rng.mixed, counter_rng.uniform, counter_rng.normal)
)


def test_no_number_is_0_so_that_its_logarithm_exists():
    smallest = mixed(mixed(7) ^ 3)  # the channel whose 32 bits are all 0
    assert uniform(7, 3, smallest) == 0.5 / 2**32
    assert math.isfinite(math.log(uniform(7, 3, smallest)))


def test_numbers_have_the_moments_that_they_should():
    numbers = [uniform(1, number, 0) for number in range(4000)]
    assert abs(sum(numbers) / 4000 - 0.5) < 0.02
    values = [normal(1, number, 0) for number in range(4000)]
    assert abs(sum(values) / 4000) < 0.05
    assert abs(sum(value * value for value in values) / 4000 - 1.0) < 0.08
