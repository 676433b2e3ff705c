"""The model card of a shipped policy as text, after Mitchell et al., "Model cards for model
reporting" (FAccT 2019).
"""

from hashlib import sha256

from eyas.benchmark.policies.shipped import card_of, file_of
from eyas.benchmark.report.reproduce.tables import TABLES, flown_of

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
            f"## What it reaches\n\n{_figures(name)}",
            "## Limits\n\n" + "\n".join(f"- {limit}" for limit in card.limits),
            f"## Other possible uses\n\n{harm}",
        )
    )


def _figures(name: str) -> str:
    """Return the rows of a policy in all tables of the documents."""
    parts = [
        "The rows of this policy in the tables that `eyas reproduce` flies again, with the number "
        "of episodes, 95 % intervals and the build that flew them."
    ]
    for table, rows in flown_of(name).items():
        columns = TABLES[table].columns
        lines = [f"| | n | {' | '.join(columns)} | build |", "|---" * (len(columns) + 3) + "|"]
        for row, one, build in rows:
            cells = [one.cells[column] for column in columns]
            label = row.label.partition(", ")[2]
            lines.append(f"| {' | '.join([label, str(one.n), *cells, f'`{build}`'])} |")
        page = TABLES[table].page
        parts += [f"{TABLES[table].title} ([about it](../{page}), `eyas reproduce {table}`):"]
        parts += ["\n".join(lines)]
    return "\n\n".join(parts)
