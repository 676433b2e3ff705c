"""What code of a user's is, for results that depend on it: package, version and a hash."""

from hashlib import sha256
from importlib import import_module
from pathlib import Path

from eyas.engine.core.config import Config

__all__ = ["Origin", "origin_of"]


class Origin(Config):
    """What code of a user's is, for results that depend on it."""

    path: str
    """`package.module:attribute`."""
    package: str | None
    """The installed package that has it; None: a module that belongs to none."""
    version: str | None
    """Of that package."""
    code: str
    """Twelve hexadecimal digits of all Python files of the package, or of the one module."""

    def __str__(self) -> str:
        """Return it in words."""
        return " ".join(filter(None, (self.package or self.path, self.version, self.code)))


def origin_of(path: str) -> Origin:
    """Return what the code at a path is, which is imported."""
    from importlib.metadata import packages_distributions, version  # slow to import

    top = path.partition(":")[0].partition(".")[0]
    module = import_module(top)
    files = sorted(
        file for folder in getattr(module, "__path__", ()) for file in Path(folder).rglob("*.py")
    )
    if not files and (alone := getattr(module, "__file__", None)) is not None:
        files = [Path(alone)]
    digest = sha256()
    for file in files:
        content = file.read_bytes()
        digest.update(f"{file.name} {len(content)} ".encode() + content)
    packages = packages_distributions().get(top)
    package = packages[0] if packages else None
    return Origin(
        path=path,
        package=package,
        version=version(package) if package else None,
        code=digest.hexdigest()[:12],
    )
