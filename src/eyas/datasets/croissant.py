"""Croissant metadata of a data set (https://docs.mlcommons.org/croissant), with a little of RAI."""

from collections.abc import Mapping
from typing import Any

from eyas.datasets.card import limits
from eyas.datasets.layout import Plan
from eyas.datasets.recipe import LICENCES
from eyas.datasets.statistics import COLUMNS
from eyas.engine.recordings.croissant import CONFORMS_TO, CONTEXT

_KINDS = {
    "sc:Integer": ("frame", "left", "top", "right", "bottom", "objects"),
    "sc:Float": ("time", "visible_fraction"),
}

_MEANINGS = {
    "picture": "Path of the picture in the data set.",
    "split": "train, val or test.",
    "part": "Name of the recording.",
    "episode": "Name of the episode, unique in the data set.",
    "frame": "Number of the frame in its episode, from 0.",
    "time": "Simulated time [s].",
    "map": "Map.",
    "weather": "Weather.",
    "left": "Left edge of the target's visible pixels.",
    "top": "Top edge of them.",
    "right": "Right edge of them, exclusive.",
    "bottom": "Bottom edge of them, exclusive.",
    "visible_fraction": "Visible share of the target, 0 to 1.",
    "target_class": "Class of the target.",
    "target_words": "The target in words.",
    "objects": "Number of visible moving objects.",
}


def croissant(plan: Plan, frames_sha256: str, notices: Mapping[str, str]) -> dict[str, Any]:
    """Return the content of `croissant.json`."""
    recipe = plan.recipe
    named = recipe.about or recipe.title
    described = {
        "@context": CONTEXT,
        "@type": "sc:Dataset",
        "conformsTo": CONFORMS_TO,
        "name": recipe.name,
        "description": named,
        "license": LICENCES[recipe.licence],
        "version": plan.eyas.partition(".dev")[0],
        "creator": {"@type": "Organization", "name": "made by its recipe with Eyas"},
        "citeAs": f"{recipe.title}, made with Eyas {plan.eyas}, build {plan.build_id}",
        "keywords": ["synthetic", "drone", "visual tracking", "object detection"],
        "rai:dataCollection": f"Rendered by a simulator: {plan.command}",
        "rai:dataCollectionType": ["Software Collection"],
        "rai:dataAnnotationProtocol": "Labels are computed from the state of the simulation.",
        "rai:dataLimitations": [limits()],
        "rai:dataBiases": ["Places, cars and people are a simulator's, of a few made-up kinds."],
        "rai:dataUseCases": ["Training and evaluation of detectors and trackers."],
        "rai:dataSocialImpact": (
            "Tracking of vehicles and people can serve rescue, film and traffic research, and also "
            "surveillance."
        ),
        "rai:personalSensitiveInformation": ["None: no real person is shown."],
        "distribution": _distribution(plan, frames_sha256),
        "recordSet": [_frames()],
    }
    published = {"datePublished": recipe.date, "url": recipe.url}
    described |= {name: value for name, value in published.items() if value is not None}
    if notices:
        described["creditText"] = " ".join(notice.strip() for notice in notices.values())
    return described


def _distribution(plan: Plan, frames_sha256: str) -> list[dict[str, Any]]:
    kinds = {"jpeg": "image/jpeg", "png": "image/png"}
    pictures = [
        {
            "@type": "cr:FileSet",
            "@id": f"pictures-{name}",
            "name": f"pictures-{name}",
            "description": "The pictures.",
            "encodingFormat": kind,
            "includes": f"parts/*/*/*/episode*/*.{name}",
        }
        for name, kind in kinds.items()
        if name in plan.recipe.writers
    ]
    return [
        {
            "@type": "cr:FileObject",
            "@id": "frames.csv",
            "name": "frames.csv",
            "description": "A row for each frame.",
            "contentUrl": "frames.csv",
            "encodingFormat": "text/csv",
            "sha256": frames_sha256,
        },
        {
            "@type": "cr:FileSet",
            "@id": "labels",
            "name": "labels",
            "description": "The labels of each episode, a line for each frame.",
            "encodingFormat": "application/jsonlines",
            "includes": "parts/*/*/*/episode*/labels.jsonl",
        },
        *pictures,
    ]


def _frames() -> dict[str, Any]:
    return {
        "@type": "cr:RecordSet",
        "@id": "frames",
        "name": "frames",
        "description": "Frames with their target.",
        "field": [
            {
                "@type": "cr:Field",
                "@id": f"frames/{column}",
                "name": column,
                "description": _MEANINGS[column],
                "dataType": _kind_of(column),
                "source": {"fileObject": {"@id": "frames.csv"}, "extract": {"column": column}},
            }
            for column in COLUMNS
        ],
    }


def _kind_of(column: str) -> str:
    return next((kind for kind, names in _KINDS.items() if column in names), "sc:Text")
