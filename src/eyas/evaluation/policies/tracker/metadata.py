"""What stands beside a network in its ONNX file."""

import json
from pathlib import Path
from typing import Any

from eyas.core.errors import DataFileError

__all__ = ["METADATA", "TRACKER", "metadata"]

METADATA, TRACKER = "eyas", "eyas.tracker"
"""Keys: changes of the defaults of `env`, and the settings of a tracker."""


def metadata(path: Path, session: Any, key: str) -> Any:  # noqa: ANN401  # whatever JSON holds
    """Return what stands under a key; an empty dictionary: nothing.

    Args:
        path: The file, for messages.
        session: Of onnxruntime.
        key: One of the above.

    Raises:
        DataFileError: It is not JSON.
    """
    described = session.get_modelmeta().custom_metadata_map.get(key, "{}")
    try:
        return json.loads(described)
    except (ValueError, RecursionError) as error:
        raise DataFileError(f"{path}: metadata '{key}': not valid JSON") from error
