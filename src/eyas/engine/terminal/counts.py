"""Numbers of things in sentences."""


def many(count: int, noun: str) -> str:
    """Return a number with a noun in its singular or plural: `1 building`, `1,260 buildings`."""
    return f"{count:,} {noun}{'' if count == 1 else 's'}"
