"""The layout and size limit of the cache, which lies in `eyas.lanes.trusted.cache_folder`.

    <folder>/<kind>/eyas-<key>.npy             arrays, see `eyas.engine.core.cache.array_file`
    <folder>/traffic/<map>-<seed>-<key>.npz    recordings of traffic
    <folder>/definitions/eyas-<key>.eyi        what source files say, see `eyas.lanes.text_index`
    <folder>/kernels/<key>/                    compiled kernels, see `eyas.lanes.machine_code`

The modification time of an entry is the time of its last use.
"""

import os
import re
from enum import StrEnum

from eyas.engine.core.errors import ConfigError

LIMIT_VARIABLE = "EYAS_CACHE_LIMIT"  # Environment variable: largest size of the cache
_DEFAULT_LIMIT = 2 << 30  # 2 GiB: a few maps in several weathers [bytes]
_UNITS = {"": 0, "K": 10, "M": 20, "G": 30, "T": 40}  # Powers of two


class EntryKind(StrEnum):
    """Kinds of entries; the value is the name of the folder in the cache."""

    PLAN = "plan"
    SCENE = "scene"
    GEOMETRY = "geometry"
    SOLIDS = "solids"
    SKY = "sky"
    SHADOWS = "shadows"
    AMBIENT = "ambient"
    TRAFFIC = "traffic"
    MOTION = "motion"
    OCCLUSION = "occlusion"
    WIND = "wind"
    DEFINITIONS = "definitions"
    KERNELS = "kernels"


def cache_limit() -> int:
    """Return the largest size of the cache [bytes].

    Raises:
        ConfigError: `EYAS_CACHE_LIMIT` is not a size.
    """
    text = os.environ.get(LIMIT_VARIABLE)
    if not text:
        return _DEFAULT_LIMIT
    size = re.fullmatch(r"\s*(\d{1,18}(?:\.\d+)?)\s*([KMGT]?)(?:i?B)?\s*", text, re.IGNORECASE)
    if size is None:
        raise ConfigError(
            f"{LIMIT_VARIABLE}: {text!r} is not allowed; allowed: bytes, or a number with "
            "K, M, G or T, for example 500M"
        )
    return int(float(size[1]) * (1 << _UNITS[size[2].upper()]))
