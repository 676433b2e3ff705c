"""A program that keeps a value; the tests start it several times.

python keeping.py CODE    # runs CODE before it asks for the value
"""

import os  # noqa: F401  # for CODE
import sys
import time  # noqa: F401
from pathlib import Path  # noqa: F401

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.cache.cached import cached
from eyas.engine.core.cache.folder import EntryKind
from eyas.engine.core.identity.program import code_of


def make() -> NDArray[np.int64]:
    print("making", flush=True)
    sys.stdin.readline()
    return np.arange(1 << 16)


code_of(make)  # which CODE may forbid to read
exec(sys.argv[1])
value = cached(EntryKind.SKY, make, (), of=NDArray[np.int64])
print(int(value.sum()), flush=True)
