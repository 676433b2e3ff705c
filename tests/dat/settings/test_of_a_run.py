"""Files of the original that ask for another world each time."""

import pytest

from eyas.dat.settings.adapter import from_original
from eyas.dat.settings.dialect import of_a_run
from eyas.engine.core.config import updated
from eyas.engine.settings.config import EyasConfig


def original(*, fixed=False, update=False):
    return from_original({"Sumo_Params": {"fixed_seed": fixed, "rou_update": update}})


def test_each_run_has_a_seed_of_its_own_which_repeats_it(caplog):
    caplog.set_level("INFO", "eyas")
    first, second = of_a_run(original()), of_a_run(original())
    assert first.seed != second.seed
    assert f"--seed {second.seed} repeats it" in caplog.messages[-1]
    assert of_a_run(updated(original(), {"seed": first.seed})) == first
    assert of_a_run(original(), first.seed) == first
    assert first.traffic.seed is None


def test_routes_are_updated_where_the_file_says_so():
    pytest.importorskip("libsumo")
    first, second = of_a_run(original(update=True)), of_a_run(original(update=True))
    assert first.traffic.seed != second.traffic.seed
    assert of_a_run(original(update=True), first.seed) == first
    assert of_a_run(first) == first  # as `config.json` has it


def test_without_sumo_a_run_begins_somewhere_in_the_recording_that_ships(monkeypatch):
    monkeypatch.setattr("eyas.dat.settings.dialect._sumo", lambda: False)
    begin = original(update=True)
    first, second = of_a_run(begin, 5), of_a_run(begin, 6)
    assert first.start.warm_up_steps != second.start.warm_up_steps
    late = (first.start.warm_up_steps - begin.start.warm_up_steps) / 500
    assert 0 < late < 1260.0 - begin.video.total_time
    assert first.video.start_time == begin.video.start_time + late
    assert of_a_run(begin, 5) == first
    assert of_a_run(first) == first  # as `config.json` has it


@pytest.mark.parametrize("config", [EyasConfig(), original(fixed=True, update=True)])
def test_all_else_stays_as_it_is(config):
    assert of_a_run(config) is config
