"""Network addresses as users write them."""

import re

from eyas.engine.core.errors import ConfigError

Address = tuple[str, int]


def parsed_address(text: str, path: str) -> Address:
    """Return host and port of `HOST:PORT`.

    Raises:
        ConfigError: It is of another form; `path` names it.
    """
    found = re.fullmatch(r"\[?([^\[\]]*?)\]?:(\d{1,5})", text)
    if found is None or not found[1] or not 1 <= int(found[2]) <= 65_535:
        raise ConfigError(f"{path}: {text!r} is not of the form HOST:PORT, such as 127.0.0.1:5600")
    return found[1], int(found[2])
