"""What PyPI shows of Eyas: addresses, and the README with absolute links; hatchling asks for both.

PyPI resolves no relative links, so those of the README lead to the files of the repository.
"""

import re
import sys
from pathlib import Path

from hatchling.metadata.plugin.interface import MetadataHookInterface

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "tools"))

from version import REPOSITORY, version  # noqa: E402  # beside this file, on no path of the builder

_LINK = re.compile(r"(!?\[[^\]]*\]\()(?!\w+:|#)([^)\s]+\))")


class PackageMetadata(MetadataHookInterface):
    """Fills `urls` and `readme`, which pyproject.toml calls dynamic."""

    PLUGIN_NAME = "custom"

    def update(self, metadata: dict[str, object]) -> None:
        """Add both to the metadata of the package."""
        release = version()
        reference = "main" if ".dev" in release else f"v{release}"
        metadata["urls"] = {
            "Repository": REPOSITORY,
            "Documentation": f"{REPOSITORY}/tree/{reference}/docs",
            "Changelog": f"{REPOSITORY}/blob/{reference}/CHANGELOG.md",
            "Issues": f"{REPOSITORY}/issues",
        }
        text = (ROOT / "README.md").read_text(encoding="utf-8")
        metadata["readme"] = {"content-type": "text/markdown", "text": absolute(text, reference)}


def absolute(text: str, reference: str) -> str:
    """Return a page of Markdown with absolute links to files, and to pictures themselves.

    Args:
        text: The page, which lies in the root of the repository.
        reference: Branch or tag of the files.
    """

    def link(found: re.Match[str]) -> str:
        kind = "raw" if found[1].startswith("!") else "blob"
        return f"{found[1]}{REPOSITORY}/{kind}/{reference}/{found[2]}"

    return _LINK.sub(link, text)
