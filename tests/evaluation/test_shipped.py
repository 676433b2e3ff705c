"""The policies that come with Eyas do what their cards say."""

import numpy as np
import pytest

from eyas.core.errors import EyasError
from eyas.evaluation.entry import entry_class
from eyas.evaluation.policies.shipped import TRAINED, card_of, file_of, shipped_names
from eyas.evaluation.policies.table import fingerprint, open_policy
from eyas.settings.preset import PRESETS

ON_A_FLOWN_DRONE = {
    "tracker": {"supervised": False, "flight": "mended"},
    "start": {"velocity": "target"},
}

IN_WORDS = {"seeds": (11_000_000,)}
"""Of `tools/ship_policy.py`."""


@pytest.mark.slow
@pytest.mark.parametrize(
    "name",
    # Who listens flies for two minutes; tests/evaluation/test_referring.py has it fly for less.
    [
        pytest.param(name, marks=pytest.mark.thorough) if name == "eyas-words" else name
        for name in shipped_names()
    ],
)
def test_a_policy_reproduces_the_first_row_of_its_card(name, fly):
    """Other processors may choose another action where two are as good to the last bit."""
    row = card_of(name).scores[0]
    settings = ON_A_FLOWN_DRONE if row.flown else {}
    records = fly(
        name,
        episodes=row.n // 4,
        protocol=row.protocol,
        weathers=(row.weather,),
        settings=settings,
        **(IN_WORDS if row.language_gap is not None else {}),
    )
    assert len(records) == row.n
    assert np.mean([record.tsr for record in records]) == pytest.approx(row.tsr, abs=0.03)
    assert np.mean([record.cr for record in records]) == pytest.approx(row.cr, rel=0.03)
    if row.success is not None:
        told = [record.figures["success_right"] for record in records]
        success = np.mean([each for each in told if each is not None])
        assert success == pytest.approx(row.success, abs=0.08)  # one of 13


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
