"""`eyas bench --device`: pictures that stay on a device."""

import re
import sys

import pytest

from eyas.cli.bench.device import ON_DEVICES, measure_on_device
from eyas.cli.bench.pictures import PictureBatch
from eyas.cli.main import main
from eyas.lanes.device import HostDevice


@pytest.mark.slow
def test_pictures_are_measured_on_any_device():
    found = measure_on_device(HostDevice(), PictureBatch(2, 48, 48, samples=2), 0.0)
    assert found.name == "pictures 48x48, 2 views, 2 samples, host"
    assert found.value > 0.0
    assert found.unit == "/s"
    assert found.repeats >= 5


def test_lines_have_names_of_their_own():
    names = [pictures.name for pictures in ON_DEVICES]
    assert len(set(names)) == len(names)


def test_without_a_card_there_is_one_line(monkeypatch, capsys):
    monkeypatch.setattr(sys, "argv", ["eyas", "bench", "--device", "cuda:9999"])
    with pytest.raises(SystemExit) as caught:
        main()
    said = capsys.readouterr()
    assert (caught.value.code, said.out) == (2, "")
    assert re.fullmatch(r"eyas: error: device: 'cuda:9999' cannot be used: [^\n]+\n", said.err)
