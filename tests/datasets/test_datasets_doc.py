"""docs/datasets.md names every key of a recipe with its default, and the files of a data set."""

import json
import re
from pathlib import Path

import pytest
from pydantic_core import to_jsonable_python

from eyas.datasets.recipe import LICENCES, SHIPPED, Recipe

PAGE = (Path(__file__).parents[2] / "docs" / "datasets.md").read_text()
TABLE = PAGE.split("<!-- recipe -->")[1].split("<!-- end -->")[0]


@pytest.mark.parametrize("name", Recipe.model_fields)
def test_the_page_has_every_key_with_its_default(name):
    field = Recipe.model_fields[name]
    told = "*must be there*"
    if not field.is_required():
        told = f"`{json.dumps(to_jsonable_python(field.default))}`"
    assert f"| `{name}` | {told} |" in TABLE


def test_the_page_has_no_other_keys():
    assert set(re.findall(r"^\| `(\w+)` \|", TABLE, re.MULTILINE)) == set(Recipe.model_fields)


def test_the_page_names_the_recipes_and_licences():
    for name in (*SHIPPED, *LICENCES):
        assert f"`{name}`" in PAGE
