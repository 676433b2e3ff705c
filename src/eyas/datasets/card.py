"""The datasheet of a data set: `README.md` in the form of the Hugging Face hub."""

import json
from collections.abc import Mapping
from itertools import pairwise
from typing import Any

from eyas.datasets.layout import RECIPE_FILE, Plan
from eyas.datasets.recipe import LICENCES, SPLITS
from eyas.datasets.statistics import EDGES, UNITS

REPOSITORY_SPLITS = {"train": "train", "val": "validation", "test": "test"}
"""Names of the splits on the hub."""

_SIZES = (
    (1_000, "n<1K"),
    (10_000, "1K<n<10K"),
    (100_000, "10K<n<100K"),
    (1_000_000, "100K<n<1M"),
    (10_000_000, "1M<n<10M"),
    (float("inf"), "10M<n<100M"),
)

_TARGET = {
    "wholly_visible": "wholly visible",
    "partly_hidden": "partly hidden",
    "hidden": "hidden",
    "out_of_view": "outside the picture",
    "cut_by_border": "cut by the border",
    "look_alike_in_view": "beside another object of its model",
}


def limits() -> str:
    """Return what data of a simulator cannot do, for datasheet and metadata."""
    return (
        "All pictures are drawn by a simulator. Textures, shapes and light are simpler than real "
        "ones, the lens has no distortion, there is no blur of motion and no noise unless the "
        "recipe asks for it, and vehicles drive as SUMO has them drive. What is learnt from them "
        "has to be checked on real pictures before it is relied on."
    )


def card(plan: Plan, statistics: Mapping[str, Any], notices: Mapping[str, str]) -> str:
    """Return the datasheet.

    Args:
        statistics: The content of `statistics.json`.
    """
    recipe, total = plan.recipe, statistics["total"]
    sample = " (a sample of a hundredth)" if plan.sample else ""
    paragraphs = [
        _front_matter(plan, total["frames"]),
        f"# {recipe.title}{sample}",
        recipe.about,
        f"{total['frames']} frames in {total['episodes']} episodes of {total['parts']} recordings, "
        f"with {total['objects']} labelled moving objects. Made by "
        f"Eyas {plan.eyas}, build `{plan.build_id}`, with\n\n"
        f"    {plan.command}\n\n"
        f"from the recipe in `{RECIPE_FILE}`; the same build makes the same bytes again.",
        "## Splits",
        _splits_table(statistics["splits"]),
        "No seed is in two splits, but places (maps) are: other episodes of their traffic."
        if recipe.shared_places
        else "No seed and no place (map) is in two splits.",
        "## What is in a frame",
        _files(plan),
        "## Composition",
        *(_table(key, total) for key in ("map", "weather", "variant") if len(total[key]) > 1),
        _counted("class", total["classes"], "objects"),
        _counted("target", _told_targets(total["targets"]), "frames"),
        *(
            _counted(f"{name} [{UNITS[name]}]" if name in UNITS else name, values, "objects")
            for name, values in range_texts(total["histograms"]).items()
            if name != "objects"
        ),
        _counted("objects in a frame", range_texts(total["histograms"])["objects"], "frames"),
        "Episodes, by what makes them hard for a tracker:",
        _counted("episodes", total["episodes_by"], "episodes"),
        "## Limits",
        limits(),
        "No real person is shown, and nothing is recorded of real places other than the maps "
        "that are named under the licence.",
        "## Licence",
        f"[{recipe.licence}]({LICENCES[recipe.licence]}), chosen by whoever made the data set.",
        *(f"Map `{name}`: {notice.strip()}" for name, notice in sorted(notices.items())),
    ]
    return "\n\n".join(paragraph for paragraph in paragraphs if paragraph) + "\n"


def _front_matter(plan: Plan, frames: int) -> str:
    recipe = plan.recipe
    size = next(name for most, name in _SIZES if frames < most)
    files = [
        f"  - split: {REPOSITORY_SPLITS[name]}\n    path: parts/{name}/*/*/*/*.{_ending(plan)}"
        for name in recipe.splits.given
    ]
    lines = [
        "---",
        f"license: {recipe.licence}",
        f"pretty_name: {json.dumps(recipe.title)}",
        "language:\n- en",
        "annotations_creators:\n- machine-generated",
        f"size_categories:\n- {size}",
        "task_categories:\n- object-detection",
        "tags:\n- synthetic\n- drone\n- visual-tracking\n- eyas\n- croissant",
        "configs:\n- config_name: default\n  data_files:",
        *files,
        "---",
    ]
    return "\n".join(lines)


def _ending(plan: Plan) -> str:
    return "png" if "png" in plan.recipe.writers else "jpeg"


def _splits_table(splits: Mapping[str, Any]) -> str:
    rows = [
        "| split | frames | episodes | recordings | objects | maps |",
        "|---|---:|---:|---:|---:|---|",
    ]
    for name in SPLITS:
        if name in splits:
            counts = splits[name]
            numbers = (counts[key] for key in ("frames", "episodes", "parts", "objects"))
            rows.append(
                f"| {name} | {' | '.join(map(str, numbers))} | {', '.join(counts['map'])} |"
            )
    return "\n".join(rows)


def _files(plan: Plan) -> str:
    writers = ", ".join(f"`{name}`" for name in plan.recipe.writers)
    text = (
        f"Each recording is a folder `parts/<split>/<name>`, as `eyas video` writes it, with "
        f"{writers}; `docs/labels.md` of Eyas tells every field of `labels.jsonl`, and "
        '`eyas.load("DIR")` reads all. `frames.csv` has a row for each frame, `dataset.json` all '
        "recordings with their seeds and checksums."
    )
    if plan.recipe.formats:
        told = ", ".join(f"`exports/{name}`" for name in plan.recipe.formats)
        text += f" The same in formats of others: {told}."
    return text


def _table(key: str, total: Mapping[str, Any]) -> str:
    return _counted(key, total[key], "frames")


def _counted(name: str, counts: Mapping[str, int], of: str) -> str:
    whole = [f"| {name} | {of} |", "|---|---:|"]
    return "\n".join([*whole, *(f"| {value} | {count} |" for value, count in counts.items())])


def _told_targets(counts: Mapping[str, int]) -> dict[str, int]:
    return {words: counts.get(key, 0) for key, words in _TARGET.items()}


def range_texts(histograms: Mapping[str, Mapping[str, int]]) -> dict[str, dict[str, int]]:
    """Return histograms by the words for their ranges, `8 to 16`."""
    told = {}
    for name, counts in histograms.items():
        edges = [f"{edge:g}" for edge in EDGES[name]]
        ranges = [f"{low} to {high}" for low, high in pairwise(edges)]
        if name == "objects":
            ranges = [
                f"{low}" if int(high) == int(low) + 1 else f"{low} to {int(high) - 1}"
                for low, high in pairwise(edges)
            ]
        words = [*ranges, f"{edges[-1]} and more"]
        told[name] = dict(zip(words, counts.values(), strict=True))
    return told
