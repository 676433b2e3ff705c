"""The page by which people look at a data set before they use it: contact sheet and statistics."""

import base64
import html
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw

from eyas.datasets.card import range_texts
from eyas.datasets.layout import Plan
from eyas.datasets.statistics import UNITS
from eyas.engine.core.codecs.jpeg import jpeg_bytes
from eyas.engine.recordings.format import objects_of
from eyas.engine.recordings.recording import RecordedEpisode, RecordedFrame

COLUMNS, ROWS = 6, 4  # Pictures in the contact sheet of a split
_TILE = (240, 180)  # Largest size of a picture in it [pixels]
_QUALITY = 88
_TARGET, _OTHER = (255, 70, 70), (90, 220, 255)  # Colours of the boxes of targets and of others
_STYLE = """
:root { color-scheme: light dark; --bar: #3b7dd8; }
body { font: 15px/1.45 system-ui, sans-serif; max-width: 92rem; margin: 1.5rem auto;
  padding: 0 1rem; }
h2 { margin: 2rem 0 .5rem; border-bottom: 1px solid #8886; }
img { width: 100%; display: block; }
code { font-size: .9em; overflow-wrap: anywhere; }
.charts { display: grid; grid-template-columns: repeat(auto-fill, minmax(19rem, 1fr));
  gap: 1rem 1.6rem; margin-top: 1rem; }
h3 { font-size: 1rem; margin: .2rem 0; }
table { border-collapse: collapse; font-variant-numeric: tabular-nums; width: 100%; }
td { padding: .05rem .3rem; white-space: nowrap; }
td:first-child { text-align: right; width: 40%; }
td:last-child { text-align: right; width: 4.5rem; opacity: .75; }
.bar { background: var(--bar); height: .75rem; border-radius: 2px; }
.key b { color: rgb(255,70,70); } .key i { color: rgb(30,150,190); font-style: normal; }
"""

_TITLES = {
    "size": "Size of visible boxes (root of area)",
    "visible": "Visible share",
    "truncated": "Share outside the picture",
    "speed": "Speed",
    "distance": "Distance from the camera",
    "objects": "Moving objects in a frame",
}


def chosen_frames(episodes: Sequence[RecordedEpisode]) -> list[RecordedFrame]:
    """Return frames for a contact sheet, from episodes spread evenly, early and late ones."""
    count = min(COLUMNS * ROWS, sum(len(episode) for episode in episodes))
    chosen = []
    for at in range(count):
        place = at * len(episodes) / count
        episode = episodes[int(place)]
        inside = (place - int(place)) if count > len(episodes) else (at * 0.618) % 1.0
        chosen.append(episode[int(inside * len(episode))])
    return chosen


def contact_sheet(frames: Sequence[RecordedFrame]) -> NDArray[np.uint8]:
    """Return pictures with the boxes of their moving objects, side by side, shape (H, W, 3)."""
    rows = max(1, -(-len(frames) // COLUMNS))
    sheet = Image.new("RGB", (COLUMNS * _TILE[0], rows * _TILE[1]), (40, 40, 40))
    for number, frame in enumerate(frames):
        tile = _tile(frame)
        left = number % COLUMNS * _TILE[0] + (_TILE[0] - tile.width) // 2
        top = number // COLUMNS * _TILE[1] + (_TILE[1] - tile.height) // 2
        sheet.paste(tile, (left, top))
    return np.asarray(sheet)


def _tile(frame: RecordedFrame) -> Image.Image:
    picture = Image.fromarray(frame.picture())
    scale = min(_TILE[0] / picture.width, _TILE[1] / picture.height)
    size = (max(1, int(picture.width * scale)), max(1, int(picture.height * scale)))
    tile = picture.resize(size, Image.Resampling.BOX if scale < 1 else Image.Resampling.NEAREST)
    drawn = ImageDraw.Draw(tile)
    for seen in objects_of(frame.label):
        left, top, right, bottom = (int(edge * scale) for edge in seen.label["visible_box"])
        colour = _TARGET if seen.is_target else _OTHER
        drawn.rectangle((left - 1, top - 1, right, bottom), outline=colour)
    return tile


def stacked(sheets: Sequence[NDArray[np.uint8]]) -> bytes:
    """Return the contact sheets of all splits below each other, a JPEG."""
    return jpeg_bytes(np.concatenate(sheets), _QUALITY)


def page(plan: Plan, statistics: Mapping[str, Any], sheets: Mapping[str, NDArray[np.uint8]]) -> str:
    """Return the page, which needs no other file.

    Args:
        statistics: The content of `statistics.json`.
    """
    recipe = plan.recipe
    title = html.escape(recipe.title + (" (a sample of a hundredth)" if plan.sample else ""))
    parts = [
        "<!doctype html>",
        f'<html lang="en"><meta charset="utf-8"><title>{title}</title>',
        f"<style>{_STYLE}</style><h1>{title}</h1><p>{html.escape(recipe.about)}</p>",
        f"<p><code>{html.escape(plan.command)}</code><br>Eyas {plan.eyas}, build "
        f"<code>{plan.build_id}</code></p>",
        '<p class="key">Boxes: <b>target</b>, <i>other moving objects</i>; the extent of visible '
        "pixels.</p>",
    ]
    for split, counts in statistics["splits"].items():
        told = (
            f"{counts['frames']} frames, {counts['episodes']} episodes, {counts['objects']} objects"
        )
        parts.append(f"<h2>{split}: {told}</h2>{_image(sheets[split], split)}")
        parts.append(f'<div class="charts">{"".join(_charts(counts))}</div>')
    return "\n".join(parts) + "\n"


def _image(sheet: NDArray[np.uint8], split: str) -> str:
    data = base64.b64encode(jpeg_bytes(sheet, _QUALITY)).decode()
    return f'<img alt="frames of {split}" src="data:image/jpeg;base64,{data}">'


def _charts(counts: Mapping[str, Any]) -> Iterator[str]:
    yield _chart("Classes", counts["classes"])
    for name, values in range_texts(counts["histograms"]).items():
        unit = f" [{UNITS[name]}]" if name in UNITS else ""
        yield _chart(_TITLES[name] + unit, values)
    yield _chart("Target, frames", {k.replace("_", " "): v for k, v in counts["targets"].items()})
    for name, values in range_texts(counts["target_histograms"]).items():
        unit = f" [{UNITS[name]}]" if name in UNITS else ""
        yield _chart(f"Target: {_TITLES[name].lower()}{unit}", values)
    yield _chart("Episodes by difficulty", counts["episodes_by"])
    for name in ("map", "weather", "variant"):
        if len(counts[name]) > 1:
            yield _chart(f"Frames by {name}", counts[name])


def _chart(title: str, counts: Mapping[str, int]) -> str:
    """Return bars with their numbers."""
    most = max(counts.values(), default=0) or 1
    rows = "".join(
        f"<tr><td>{html.escape(name)}</td>"
        f'<td><div class="bar" style="width:{100 * count / most:.1f}%"></div></td>'
        f"<td>{count}</td></tr>"
        for name, count in counts.items()
    )
    return f"<div><h3>{html.escape(title)}</h3><table>{rows}</table></div>"
