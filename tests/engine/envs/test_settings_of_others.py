"""Settings that someone else has written: refused in one line; nothing runs that is not used."""

import json
import sys

import pytest

from eyas.cli.main import main
from eyas.engine.core.errors import EyasError
from eyas.engine.envs.tracking_env import TrackingEnv
from eyas.engine.exports.registry import chosen_writers

NAMES = [
    "..evil:x",
    "../evil:x",
    "a/b:c",
    ".:x",
    "a:b:c",
    "os:__doc__",
    "\0:x",
    "/etc/passwd",
    "../../etc/passwd",
    "~nobody-has-this-name/x",
    "\n:\n",
    "\x1b[31m:x",
    "\ud800:x",
    "a" * 10_000 + ":b",
]
USES = {
    "map": lambda name: TrackingEnv({"world": {"map": name}}),
    "weather": lambda name: TrackingEnv({"world": {"weather": name}}),
    "recording": lambda name: TrackingEnv({"traffic": {"recording": name}}),
    "term": lambda name: TrackingEnv({"reward": {"terms": {name: 1.0}}}),
    "writer": lambda name: chosen_writers((name,)),
    "preset or file": TrackingEnv,
}


@pytest.mark.parametrize("use", USES)
@pytest.mark.parametrize("name", NAMES, ids=lambda name: ascii(name)[:20])
def test_a_name_that_leads_elsewhere_is_one_line(use, name):
    with pytest.raises(EyasError) as caught:
        USES[use](name)
    line = str(caught.value)
    assert line.isprintable()
    assert len(line) < 5000


def test_reading_settings_imports_nothing_that_they_name(tmp_path, monkeypatch, capsys):
    (tmp_path / "evil_part.py").write_text("raise SystemExit('executed')")
    monkeypatch.syspath_prepend(tmp_path)
    named = "evil_part:thing"
    settings = {
        "world": {"map": named},
        "reward": {"terms": {named: 1.0}},
        "video": {"writers": [named]},
    }
    path = tmp_path / "settings.json"
    path.write_text(json.dumps(settings))
    for command in (("show", "--config", path), ("show", "--legacy", "--config", path)):
        monkeypatch.setattr(sys, "argv", ["eyas", "config", *map(str, command)])
        with pytest.raises(SystemExit) as caught:
            main()
        assert not caught.value.code or "cannot be expressed" in capsys.readouterr().err
    assert "evil_part" not in sys.modules
