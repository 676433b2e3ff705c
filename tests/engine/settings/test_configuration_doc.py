"""The documents name every setting with its default, and every key of the original."""

import json
from pathlib import Path

import pytest

from eyas.dat.settings.keys import ENTRIES
from eyas.dat.settings.layout import original_defaults
from eyas.engine.core.config import group_of
from eyas.engine.settings.config import EyasConfig

DOCS = Path(__file__).parents[3] / "docs"
SETTINGS = (DOCS / "reference" / "settings.md").read_text().splitlines()
DOC = (DOCS / "configuration.md").read_text().splitlines()


def settings(group=EyasConfig, path=""):
    values = json.loads(group().model_dump_json())
    for name, field in group.model_fields.items():
        if values[name] is not None and (inner := group_of(field)):
            yield from settings(inner, f"{path}{name}.")
        else:
            yield f"{path}{name}", values[name]


@pytest.mark.parametrize(("path", "default"), list(settings()))
def test_the_page_has_every_setting_with_its_default(path, default):
    row = f"| `{path}` | `{json.dumps(default)}` |"
    assert any(line.startswith(row) for line in SETTINGS), f"needs a row {row}"


@pytest.mark.parametrize("entry", ENTRIES, ids=lambda entry: entry.keys[0])
def test_the_page_has_every_key_of_the_original(entry):
    ours = ", ".join(f"`{path}`" for path in entry.paths)
    for key in entry.keys:
        group, _, name = key.rpartition(".")
        default = original_defaults()[group][name] if group else original_defaults()[name]
        assert f"| `{key}` | `{json.dumps(default)}` | {ours} |" in DOC
