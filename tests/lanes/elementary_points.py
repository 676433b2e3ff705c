"""How far elementary functions are from the true values.

    python tests/lanes/elementary_points.py            # 10^6 points of each function
    python tests/lanes/elementary_points.py 10000 sin  # fewer, of some

All points are compared with long doubles, whose own errors are a thousand times smaller where they
have 64 bits; the worst of them, and some at random, with mpmath at 300 bits.
"""

import sys

import mpmath
import numpy as np

from eyas.lanes.elementary import arrays as elementary_arrays

MPMATH = {
    "acos": mpmath.acos,
    "asin": mpmath.asin,
    "atan": mpmath.atan,
    "atan2": mpmath.atan2,
    "cos": mpmath.cos,
    "exp": mpmath.exp,
    "hypot": mpmath.hypot,
    "log": mpmath.log,
    "power": mpmath.power,
    "sin": mpmath.sin,
    "tan": mpmath.tan,
    "tanh": mpmath.tanh,
}
NUMPY = {"acos": np.arccos, "asin": np.arcsin, "atan": np.arctan, "atan2": np.arctan2}
LONG = np.finfo(np.longdouble).nmant >= 63
"""Whether long doubles are any better than doubles here."""

WORST = 300


def points(name, count, rng):
    """Return arguments of a function: where it is used, everywhere, and where it is hard."""

    def flat(low, high):
        return rng.uniform(low, high, part)

    def spread(low, high):
        return np.exp2(flat(low, high)) * rng.choice([-1.0, 1.0], part)

    part = -(-count // 4)
    if name in ("sin", "cos", "tan"):
        near = np.round(flat(-600_000, 600_000)) * (np.pi / 2)
        sets = [(flat(-4, 4),), (spread(-30, 30),), (spread(30, 1023),), (near,)]
    elif name in ("asin", "acos"):
        sets = [(flat(-1, 1),), (1 - np.exp2(flat(-53, 0)),), (spread(-50, 0),), (flat(0.4, 0.6),)]
    elif name == "exp":
        sets = [(flat(-2, 2),), (flat(-700, 709),), (spread(-60, 2),), (flat(-30, 30),)]
    elif name == "log":
        sets = [
            (flat(0, 3),),
            (np.exp2(flat(-1022, 1023)),),
            (1 + spread(-52, -2),),
            (flat(0, 1e6),),
        ]
    elif name in ("atan", "tanh"):
        sets = [(flat(-1, 1),), (flat(-4, 4),), (spread(-60, 5),), (spread(-3, 3),)]
    elif name == "power":
        base = np.exp2(flat(-30, 30))
        largest = (base, flat(-690, 690) / np.log(base))
        sets = [(flat(0, 5), flat(-5, 5)), largest, (1 + spread(-20, -2), spread(0, 9))]
        sets.append((flat(0.01, 100), np.full(part, 1.2)))
    else:
        x, y = spread(-900, 900), spread(-3, 3)
        sets = [(flat(-4, 4), flat(-4, 4)), (spread(-9, 9), spread(-9, 9)), (x, x * y)]
        sets.append((spread(-300, 300), spread(-300, 300)))
    return [np.concatenate(values) for values in zip(*sets, strict=True)]


def largest_error(name, count, seed=0):
    """Return the largest error of a function at random points [units in the last place]."""
    rng = np.random.default_rng(seed)
    arguments = points(name, count, rng)
    found = getattr(elementary_arrays, name)(*arguments)
    chosen = rng.integers(0, len(found), WORST)
    if LONG:
        long = NUMPY.get(name, getattr(np, name, None))(
            *(a.astype(np.longdouble) for a in arguments)
        )
        apart = np.abs((found - long) / np.spacing(np.abs(found)))
        chosen = np.append(chosen, np.argsort(apart)[-WORST:])
    worst = 0.0
    with mpmath.workprec(300 if name not in ("sin", "cos", "tan") else 1400):
        for k in chosen.tolist():
            true = MPMATH[name](*(mpmath.mpf(float(a[k])) for a in arguments))
            unit = float(np.spacing(abs(float(true))))
            worst = max(worst, float(abs(mpmath.mpf(float(found[k])) - true) / unit))
    return worst


if __name__ == "__main__":
    wanted = sys.argv[2:] or list(MPMATH)
    for function in wanted:
        print(
            function,
            f"{largest_error(function, int(sys.argv[1]) if sys.argv[1:] else 1_000_000):.3f}",
        )
