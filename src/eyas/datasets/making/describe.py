"""Writes the files that describe a data set, from what is known of its parts."""

import csv
import hashlib
import io
import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from eyas.datasets.card import card
from eyas.datasets.croissant import croissant
from eyas.datasets.layout import RECIPE_FILE, Plan
from eyas.datasets.overview import chosen_frames, contact_sheet, page, stacked
from eyas.datasets.plan import Part
from eyas.datasets.statistics import COLUMNS, PartFacts, added
from eyas.engine.core.files import write_atomic
from eyas.engine.recordings.recording import load_part
from eyas.engine.world.maps import MAPS
from eyas.engine.world.maps.recipe import ATTRIBUTION_FILE


def describe(plan: Plan, parts: Sequence[tuple[Part, PartFacts]], root: Path) -> None:
    """Write recipe, table of frames, statistics, overview, datasheet and metadata.

    Raises:
        OutputError: A file cannot be written.
        DataFileError: A picture cannot be read.
    """
    rows = _table(parts)
    statistics = _statistics(parts)
    notices = _notices(parts)
    _write(root / RECIPE_FILE, plan.recipe.model_dump(mode="json"))
    write_atomic(root / "frames.csv", rows)
    _write(root / "statistics.json", statistics)
    _overview(plan, parts, statistics, root)
    write_atomic(root / "README.md", card(plan, statistics, notices).encode())
    _write(root / "croissant.json", croissant(plan, hashlib.sha256(rows).hexdigest(), notices))
    if notices:
        told = "\n".join(f"{name}: {notice.strip()}\n" for name, notice in notices.items())
        write_atomic(root / ATTRIBUTION_FILE, told.encode())


def _write(path: Path, content: Any) -> None:  # noqa: ANN401  # JSON
    write_atomic(path, (json.dumps(content, indent=1, ensure_ascii=False) + "\n").encode())


def _table(parts: Sequence[tuple[Part, PartFacts]]) -> bytes:
    text = io.StringIO()
    table = csv.writer(text, lineterminator="\n")
    table.writerow(COLUMNS)
    for _, facts in parts:
        table.writerows(facts.rows)
    return text.getvalue().encode()


def _statistics(parts: Sequence[tuple[Part, PartFacts]]) -> dict[str, Any]:
    """Return the counts of all splits, and of all together."""
    of_split: dict[str, list[dict[str, Any]]] = {}
    for part, facts in parts:
        of_split.setdefault(part.split, []).append(facts.counts)
    splits = {name: _in_order(added(counts)) for name, counts in of_split.items()}
    return {"total": _in_order(added(splits.values())), "splits": splits}


def _in_order(counts: dict[str, Any]) -> dict[str, Any]:
    """Return counts whose names are not in the order in which parts happen to have them."""
    names = ("classes", "types", "targets", "episodes_by")
    return {**counts, **{name: dict(sorted(counts[name].items())) for name in names}}


def _notices(parts: Sequence[tuple[Part, PartFacts]]) -> dict[str, str]:
    names = dict.fromkeys(part.config.world.map for part, _ in parts)
    told = {name: MAPS.get(name).attribution() for name in names}
    return {name: notice for name, notice in told.items() if notice}


def _overview(
    plan: Plan,
    parts: Sequence[tuple[Part, PartFacts]],
    statistics: dict[str, Any],
    root: Path,
) -> None:
    sheets = {}
    for split in statistics["splits"]:
        own = [part for part, _ in parts if part.split == split]
        episodes = [each for part in own for each in load_part(root, split, part.name)]
        pictured = [each for each in episodes if each.has("jpeg") or each.has("png")]
        sheets[split] = contact_sheet(chosen_frames(pictured))
    write_atomic(root / "overview.jpeg", stacked(list(sheets.values())))
    write_atomic(root / "overview.html", page(plan, statistics, sheets).encode())
