"""Croissant metadata of evaluated episodes (https://docs.mlcommons.org/croissant), with its part
for responsible AI.
"""

from typing import Any

from eyas.benchmark.plan.plan import Stamp
from eyas.benchmark.records.record import EpisodeRecord
from eyas.engine.recordings.croissant import CONFORMS_TO, CONTEXT

_FILE = "episodes.jsonl"
_TYPES = {str: "sc:Text", int: "sc:Integer", float: "sc:Float", bool: "sc:Boolean"}

_MEANINGS = {
    "name": "Name of the episode, unique in the evaluation.",
    "map": "Map.",
    "weather": "Weather.",
    "target": "Kind of the target.",
    "direction": "Heading of the drone relative to its target's at the start [rad].",
    "seed": "Seed from which all that is random in the episode follows.",
    "variant": "Which of the versions of one episode it is, where a protocol has several.",
    "reason": "Why the episode has ended.",
    "duration": "How long it lasted [s].",
    "cr": "Sum of the continuous reward over the control steps.",
    "tsr": "Share of all control steps with the target in the picture.",
    "seen": "Share of looks at which a pixel of the target is visible.",
    "visible": "Mean visible share of the target.",
    "clear": "The same for a drone exactly above the target.",
    "watched": "Time until the target is lost [s].",
    "losses": "Number of losses.",
    "found_again": "Losses after which the target was found again.",
    "crashed": "Whether a limit of the body has ended the episode.",
    "centre_error": "Mean distance of the target from the middle of the picture [m].",
    "path": "Length of the flight [m].",
    "height": "Mean height above the target [m].",
    "jerk": "Root mean square of the change of acceleration [m/s^3].",
}
"""The columns that every episode has. Those that may be missing, and the figures of a protocol of
its own, are in the file too."""


def croissant(made: Stamp, sha256: str) -> dict[str, Any]:
    """Return the content of `croissant.json`."""
    plan = made.plan
    title = f"{plan.policy} in protocol {plan.protocol}"
    return {
        "@context": CONTEXT,
        "@type": "sc:Dataset",
        "conformsTo": CONFORMS_TO,
        "name": "eyas-evaluation",
        "description": f"{title}: {plan.rules.title}.",
        "license": "https://creativecommons.org/publicdomain/zero/1.0/",
        "version": made.version,
        "creator": {"@type": "Organization", "name": "made with Eyas by whoever flew the policy"},
        "citeAs": f"{title}, flown with Eyas {made.version}, build {made.build.id}",
        "keywords": ["synthetic", "drone", "visual tracking", "benchmark"],
        "rai:dataCollection": f"Simulated: {plan.command}",
        "rai:dataCollectionType": ["Software Collection"],
        "rai:dataAnnotationProtocol": "Figures are computed from the state of the simulation.",
        "rai:dataLimitations": [
            "Simulated flights: how far they hold for real ones has not been measured.",
            "Episodes are starts in a few recordings of simulated traffic on the named maps.",
        ],
        "rai:dataBiases": [
            "Roads, cars, people and light are of a few made-up places; most targets are cars."
        ],
        "rai:dataUseCases": ["Comparison of policies that track a target with a drone."],
        "rai:dataSocialImpact": (
            "Tracking of vehicles and people can serve rescue, film and traffic research, and also "
            "surveillance. No real person, place or number plate is in the episodes."
        ),
        "rai:personalSensitiveInformation": ["None: no real person is shown."],
        "distribution": [
            {
                "@type": "cr:FileObject",
                "@id": _FILE,
                "name": _FILE,
                "contentUrl": _FILE,
                "encodingFormat": "application/jsonlines",
                "sha256": sha256,
            }
        ],
        "recordSet": [
            {
                "@type": "cr:RecordSet",
                "@id": "episodes",
                "name": "episodes",
                "description": "One record for each flown episode.",
                "field": [_field(name) for name in _MEANINGS],
            }
        ],
    }


def _field(name: str) -> dict[str, Any]:
    kind = EpisodeRecord.model_fields[name].annotation
    return {
        "@type": "cr:Field",
        "@id": f"episodes/{name}",
        "name": name,
        "description": _MEANINGS[name],
        "dataType": _TYPES.get(kind, "sc:Text") if isinstance(kind, type) else "sc:Text",
        "source": {"fileObject": {"@id": _FILE}, "extract": {"column": name}},
    }
