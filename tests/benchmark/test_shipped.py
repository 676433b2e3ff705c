"""The policies that come with Eyas do what their cards say."""

import pytest

from eyas.benchmark.plan.entry import entry_class
from eyas.benchmark.policies.shipped import TRAINED, card_of, file_of, shipped_names
from eyas.benchmark.policies.table import fingerprint, open_policy
from eyas.engine.core.errors import EyasError
from eyas.engine.settings.file import PRESETS


def test_each_was_trained_by_its_command():
    assert shipped_names()
    for name in shipped_names():
        preset = name.removesuffix("-flown")
        assert f"eyas train --preset {preset} --seed " in card_of(name).command
        assert preset in PRESETS
        assert entry_class(open_policy(name, {})) == card_of(name).entry_class
        assert fingerprint(name) == fingerprint(str(file_of(name)))


def test_together_they_are_small():
    assert sum(path.stat().st_size for path in TRAINED.iterdir()) < 10e6


def test_a_name_that_is_nearly_one_is_told():
    with pytest.raises(EyasError, match=r"'fsat'.*'fast'"):
        open_policy("fsat", {})
