"""`eyas bench --device`: pictures that stay on a device."""

import pytest

from eyas.core.errors import ConfigError
from eyas.lanes.device import HostDevice
from eyas.modes.bench.device import ON_DEVICES, card_of, measure_on_device
from eyas.modes.bench.pictures import PictureBatch


def test_pictures_are_measured_on_any_device():
    found = measure_on_device(HostDevice(), PictureBatch(2, 48, 48, samples=2), 0.0)
    assert found.name == "pictures 48x48, 2 views, 2 samples, host"
    assert found.value > 0.0
    assert found.unit == "/s"
    assert found.repeats >= 5


def test_lines_have_names_of_their_own():
    names = [pictures.name for pictures in ON_DEVICES]
    assert len(set(names)) == len(names)


@pytest.mark.parametrize("name", ["cpu", "cuda:", "cuda:x"])
def test_other_devices_are_refused_by_name(name):
    with pytest.raises(ConfigError, match="^--device: '" + name + "' is not allowed"):
        card_of(name)


def test_no_card_is_one_line():
    with pytest.raises(ConfigError, match=r"^--device: 'cuda:9999' cannot be used: [^\n]+$"):
        card_of("cuda:9999")
