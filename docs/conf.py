"""Settings of the site: `sphinx-build -W docs site`, with the extra `docs`.

The pages stay as GitHub shows them: what only the site has, such as navigation below a page and
references made from the code, is put in while they are read.
"""

import re
import sys
from pathlib import Path

from sphinx.application import Sphinx

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE.parent / "tools"))

import site_reference  # noqa: E402  # of tools
from version import REPOSITORY  # noqa: E402

project = "Eyas"
author = "The Eyas developers"
copyright = "The Eyas developers; MIT licence"  # Sphinx's word
extensions = [
    *("myst_parser", "sphinx.ext.autodoc", "sphinx.ext.napoleon", "sphinx.ext.viewcode"),
    "sphinx_copybutton",
]
source_suffix = [".md"]

suppress_warnings = ["myst.header"]  # pages whose first heading is below another's
myst_heading_anchors = 4
default_role = "literal"
nitpicky = False

autodoc_member_order = "bysource"
autodoc_typehints = "description"
maximum_signature_line_length = 100  # else a line for each parameter
autodoc_mock_imports = ["torch", "stable_baselines3", "pettingzoo"]  # extras, slow to import
autodoc_default_options = {"members": True}
napoleon_numpy_docstring = False
napoleon_use_ivar = True  # else a field that has a docstring too is described twice

html_theme = "furo"
html_title = "Eyas"
html_logo = html_favicon = "_static/logo.svg"
html_theme_options = {
    "source_repository": REPOSITORY,
    "source_branch": "main",
    "source_directory": "docs/",
    "top_of_page_buttons": ["view", "edit"],
}
html_static_path = ["_static"]
html_css_files = ["site.css"]
html_extra_path = ["films", "settings.schema.json", "labels.schema.json"]
linkcheck_ignore = [r"https://github\.com/OWNER/"]
linkcheck_anchors_ignore_for_url = [r"https://github\.com/"]  # made by their scripts
linkcheck_timeout = 30
html_show_sphinx = False
copybutton_prompt_text = "$ "
html_show_sourcelink = False
html_copy_source = False

BELOW = {
    "camera": "camera/*",
    "maps/README": "maps/*",
    "protocols/README": "protocols/*",
    "decisions/README": "decisions/*",
    "lab/README": "lab/*",
    "policies/README": "policies/*",
    "reference/api": "reference/api/*",
}
"""Pages with pages of their own below them in the navigation."""
OUTSIDE = {"CONTRIBUTING.md": "contributing.md", "CHANGELOG.md": "changelog.md"}
"""Files beside `docs` that the site has as pages."""


def complete(app: Sphinx, page: str, source: list[str]) -> None:
    """Put into a page what only the site has."""
    text = source[0]
    up = "../" * page.count("/")
    for file, own in OUTSIDE.items():
        text = re.sub(rf"\]\((?:\.\./)+{re.escape(file)}", f"]({up}{own}", text)
    text = re.sub(r"\]\((?:\.\./)+((?:art/)?README\.md)", rf"]({REPOSITORY}/blob/main/\1", text)
    for name, made in site_reference.MADE.items():
        marker = f"<!-- site: {name} -->"
        if marker in text:  # with what readers of the file see in its place
            text = text.partition(marker)[0] + made()
    if page in BELOW:
        below = BELOW[page].removeprefix(f"{page.rpartition('/')[0]}/")
        text += f"\n\n```{{toctree}}\n:hidden:\n:glob:\n\n{below}\n```\n"
    source[0] = text


def beside(app: Sphinx, page: Path, docname: str, source: list[str]) -> None:
    """Correct the links of a file beside `docs` that a page includes."""
    source[0] = re.sub(r"\]\(docs/", "](", source[0])


KEPT: dict[str, list[str]] = {}
"""Docstrings of fields, which napoleon would take apart at their first colon."""
FIELDS = ("attribute", "data", "property")


def keep(app: Sphinx, what: str, name: str, of: object, options: object, lines: list[str]) -> None:
    """Hide the docstring of a field from napoleon."""
    if what in FIELDS:
        KEPT[name], lines[:] = lines[:], []


def give_back(
    app: Sphinx, what: str, name: str, of: object, options: object, lines: list[str]
) -> None:
    """Show it again."""
    if what in FIELDS:
        lines[:] = KEPT.pop(name, lines)


def for_agents(app: Sphinx, failure: Exception | None) -> None:
    """Write the list of pages for programs that read it, with links to the site's own pages."""
    if failure is None and app.builder.format == "html":
        text = (HERE / "llms.txt").read_text(encoding="utf-8")
        (Path(app.outdir) / "llms.txt").write_text(text.replace(".md)", ".html)"), encoding="utf-8")


def outdated(app: Sphinx, env: object, *sets: set[str]) -> list[str]:
    """Return the pages that are made from the code, which may have changed though they have not."""
    groups = [f"reference/{name}" for name in site_reference.MADE if name.startswith("api/")]
    return ["reference/api", *groups, "reference/commands", "speed"]


def setup(app: Sphinx) -> None:
    """Connect the above to Sphinx."""
    app.connect("source-read", complete)
    app.connect("build-finished", for_agents)
    app.connect("env-get-outdated", outdated)
    app.connect("autodoc-process-docstring", keep, priority=400)  # napoleon has 500
    app.connect("autodoc-process-docstring", give_back, priority=600)
    app.connect("include-read", lambda app, path, doc, source: beside(app, path, doc, source))
