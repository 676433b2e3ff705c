"""The public names: what there is, from where, and with which signatures.

After a change that is meant: `pytest tests/test_public_names.py --regenerate`.
"""

import ast
import enum
import inspect
import re
import subprocess
import sys
from pathlib import Path

import eyas

KNOWN = Path(__file__).with_name("public_names.txt")
SOURCE = ast.parse(Path(eyas.__file__).read_text())


def described(name: str) -> str:
    """Return a line about a public name."""
    value = getattr(eyas, name)
    if inspect.isclass(value):
        if issubclass(value, enum.Enum | Exception):
            return f"class {name}"
        members = [
            each
            for each in sorted(vars(value))
            if not each.startswith("_") and not each.startswith("model_")
        ]
        return f"class {name}: {', '.join(members)}"
    if inspect.isfunction(value):
        signature = inspect.signature(value)
        plain = [p.replace(annotation=p.empty) for p in signature.parameters.values()]
        # Without types, which other versions of Python and numpy print otherwise.
        return f"def {name}{signature.replace(parameters=plain, return_annotation=signature.empty)}"
    return name


def test_the_public_names_have_the_signatures_that_are_written_down(regenerate):
    found = "".join(f"{described(name)}\n" for name in sorted(eyas.__all__))
    if regenerate:
        KNOWN.write_text(found)
    assert found == KNOWN.read_text()


def test_type_checkers_see_the_same_names():
    (block,) = (node for node in SOURCE.body if isinstance(node, ast.If))
    seen = {
        alias.asname: node.module
        for node in block.body
        if isinstance(node, ast.ImportFrom)
        for alias in node.names
    }
    assert seen == eyas._MODULE_OF


def test_a_public_name_is_imported_when_it_is_asked_for():
    code = (
        "import sys, eyas; assert 'numpy' not in sys.modules, 'numpy'; "
        "assert 'TrackingEnv' in dir(eyas); from eyas import Snapshot; eyas.Snapshot.create(1); "
        "assert 'torch' not in sys.modules"
    )
    subprocess.run([sys.executable, "-c", code], check=True)


def test_examples_and_documents_take_public_names_only():
    """Comments of pages hold what a test of a block in the midst of a program needs."""
    root = Path(__file__).parents[1]
    pages = [*root.glob("examples/*.py"), *root.glob("docs/**/*.md"), root / "README.md"]
    deep = [
        f"{page.relative_to(root)}: {line.strip()}"
        for page in pages
        for line in re.sub(r"<!--.*?-->", "", page.read_text(), flags=re.S).splitlines()
        if line.startswith(("from eyas.", "import eyas.", "    from eyas."))
    ]
    assert deep == []
