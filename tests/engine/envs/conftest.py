"""What several tests of environments need."""

import warnings

import pytest


@pytest.fixture(scope="session")
def official():
    """PettingZoo's own tests; importing them warns of its own games."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return pytest.importorskip("pettingzoo.test")
