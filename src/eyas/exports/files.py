"""The names of the files that a writer writes."""

import re
from collections.abc import Iterable
from dataclasses import dataclass
from string import Formatter

__all__ = ["Files", "joined", "pattern_of"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Files:
    """Names of files. `{:06d}` stands for a number; `/` separates folders."""

    frame: tuple[str, ...] = ()
    """Those of each frame, relative to the episode's folder, such as `{:06d}.jpeg`. They are
    written during the episode, so they do not show whether it has ended."""
    episode: tuple[str, ...] = ()
    """Those written at the end of an episode, relative to its folder."""
    run: tuple[str, ...] = ()
    """Those written at the end of the recording, relative to its folder."""

    def __post_init__(self) -> None:
        for name in (*self.frame, *self.episode, *self.run):
            pattern_of(name)


def joined(several: Iterable[Files]) -> Files:
    """Return all names of several writers."""
    listed = list(several)
    return Files(
        frame=tuple(name for files in listed for name in files.frame),
        episode=tuple(name for files in listed for name in files.episode),
        run=tuple(name for files in listed for name in files.run),
    )


def pattern_of(name: str) -> str:
    r"""Return a regular expression for a name in the notation of `Files`: `\d{6,}` for `{:06d}`.

    Raises:
        ValueError: A field of the name is not a number.
    """
    parts = []
    for literal, field, layout, _ in Formatter().parse(name):
        parts.append(re.escape(literal))
        if field is not None:
            digits = re.fullmatch(r"0?(\d{0,2})d", layout or "")
            if not digits:
                raise ValueError(f"{name!r} is not a file's name; a number in it is like {{:06d}}")
            parts.append(rf"\d{{{digits[1] or 1},}}")
    return "".join(parts)
