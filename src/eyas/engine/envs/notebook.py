"""Environments in notebooks: a strip of pictures, and a line about them."""

import base64
import sys
from collections.abc import Sequence
from html import escape

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.codecs.png import png_bytes

LONGEST_STRIP = 6  # Largest number of pictures of a strip


def strip_html(pictures: Sequence[NDArray[np.uint8]], line: str) -> str:
    """Return HTML that needs no other file: pictures (H, W, 3) side by side, and a line."""
    shown = "".join(
        f'<img alt="" style="height: 180px; margin-right: 4px" src="data:image/png;base64,'
        f'{base64.b64encode(png_bytes(picture)).decode()}"/>'
        for picture in pictures[:LONGEST_STRIP]
    )
    row = f'<div style="white-space: nowrap; overflow-x: auto">{shown}</div>'
    return f"<div>{row}{escape(line)}</div>"


def show_wrapped() -> None:
    """Let notebooks show an environment that Gymnasium's wrappers are around, as `make` returns.

    Where no notebook runs, nothing is done: IPython is never imported for it.
    """
    ipython = sys.modules.get("IPython")
    shell = None if ipython is None else ipython.get_ipython()
    if shell is None:
        return
    import gymnasium

    shell.display_formatter.formatters["text/html"].for_type(gymnasium.Wrapper, _of_wrapper)


def _of_wrapper(env: object) -> str | None:
    own = getattr(getattr(env, "unwrapped", None), "_repr_html_", None)
    return None if own is None else str(own())
