"""Code of a user that settings name, and what identifies it in results."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from hashlib import sha256
from importlib import import_module
from pathlib import Path

from eyas.engine.core.config import Config

PICKLED = (".zip", ".pt", ".pth", ".pt2")
"""Endings of files of networks that may run code when they are read."""


@dataclass(frozen=True, slots=True)
class NamesCode:
    """Marks a field, in `Annotated`, whose texts or keys with a colon are imported and called, and
    whose files in Python's own format run what is in them.
    """


NAMES_CODE = NamesCode()


def code_named(config: Config, path: str = "") -> Iterator[tuple[str, str]]:
    """Yield each piece of code that settings name: path of the setting, and what it names."""
    for name, field in type(config).model_fields.items():
        value, inner = getattr(config, name), f"{path}.{name}".lstrip(".")
        if NAMES_CODE in field.metadata:
            for text in _texts(value):
                if ":" in text or text.endswith(PICKLED):
                    yield inner, text
        elif isinstance(value, Config):
            yield from code_named(value, inner)
        elif isinstance(value, tuple):
            for number, part in enumerate(value):
                if isinstance(part, Config):
                    yield from code_named(part, f"{inner}.{number}")


def _texts(value: object) -> Iterator[str]:
    if isinstance(value, str):
        yield value
    elif isinstance(value, Mapping | tuple):
        yield from (part for part in value if isinstance(part, str))


class Origin(Config):
    """Identity of code of a user, for results that depend on it."""

    path: str
    """`package.module:attribute`."""
    package: str | None
    """The installed package that has it; None: a module that belongs to none."""
    version: str | None
    """Version of that package."""
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
