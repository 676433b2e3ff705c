"""The model card of a shipped policy as text, after Mitchell et al., "Model cards for model
reporting" (FAccT 2019).
"""

from hashlib import sha256

from eyas.evaluation.policies.shipped import Card, Score, card_of, file_of

__all__ = ["model_card"]

_USE = (
    "As a baseline to compare trackers with, as a start for further training, and to show what "
    "Eyas teaches. It has seen drawn pictures only: whether it follows a real car has not been "
    "tried, and it must not steer a real drone."
)

_HARM = (
    "Following vehicles and people can serve rescue, film and traffic research, and also "
    "surveillance. The policy follows what is {shown}; it knows no person, no number plate and no "
    "real place."
)

_SHOWN = {
    "pixels": "in the middle of its first picture",
    "box": "in its first box",
    "text+pixels": "named",
}
"""What a policy follows, by its class."""


def model_card(name: str) -> str:
    """Return the card of a shipped policy as Markdown."""
    card = card_of(name)
    digest = sha256(file_of(name).read_bytes()).hexdigest()
    harm = _HARM.format(shown=_SHOWN[card.entry_class])
    return "\n\n".join(
        (
            f"# Model card: `{name}`",
            f"A network that follows a target with a drone. It has learned {card.title}.",
            f"| | |\n|---|---|\n| class of entry | `{card.entry_class}` |\n"
            f"| trained by | `{card.command}` |\n"
            f"| decisions in training | {card.decisions:,} |\n| Eyas | {card.version} |\n"
            f"| file | `{file_of(name).name}`, SHA-256 `{digest}` |\n| licence | MIT, as Eyas |",
            f"## Intended use\n\n{_USE}",
            f"## Trained on\n\n{card.trained_on}",
            f"## What it reaches\n\n{_scores(card)}",
            "## Limits\n\n" + "\n".join(f"- {limit}" for limit in card.limits),
            f"## What it could be used for besides\n\n{harm}",
        )
    )


def _scores(card: Card) -> str:
    told = any(score.language_gap is not None for score in card.scores)
    rows = "\n".join(map(_told_row if told else _row, card.scores))
    figures = "success | language gap" if told else "CR | TSR"
    return (
        "Means over the episodes of protocols (`docs/evaluation.md`), which training has not had.\n"
        f"\n| protocol | map | weather | n | {figures} |\n|---|---|---|---|---|---|\n{rows}"
    )


def _told_row(score: Score) -> str:
    place = f"{score.protocol} | {score.map} | {score.weather} | {score.n}"
    return f"| {place} | {score.success:.3f} | {score.language_gap:.3f} |"


def _row(score: Score) -> str:
    changed = score.target if score.target != "SUMO_VEHICLE" else ""
    late = f"{score.latency} ms late" if score.latency != "0" else ""
    drone = "flown drone" if score.flown else ""
    protocol = ", ".join(filter(None, (score.protocol, changed, late, drone)))
    cells = (protocol, score.map, score.weather, str(score.n))
    return f"| {' | '.join(cells)} | {score.cr:.1f} | {score.tsr:.3f} |"
