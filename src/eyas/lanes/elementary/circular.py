"""Sine, cosine and tangent.

The polynomials are those of fdlibm (Sun Microsystems, 1993: `k_sin.c`, `k_cos.c`, `k_tan.c`), best
approximations for an eighth of a turn to both sides.
"""

from eyas.lanes.elementary.exact import leading
from eyas.lanes.elementary.reduction import reduced
from eyas.lanes.jit import kernel

_S1, _S2, _S3 = -1.66666666666666324348e-01, 8.33333333332248946124e-03, -1.98412698298579493134e-04
_S4, _S5, _S6 = 2.75573137070700676789e-06, -2.50507602534068634195e-08, 1.58969099521155010221e-10

_C1, _C2, _C3 = 4.16666666666666019037e-02, -1.38888888888741095749e-03, 2.48015872894767294178e-05
_C4, _C5, _C6 = (
    -2.75573143513906633035e-07,
    2.08757232129817482790e-09,
    -1.13596475577881948265e-11,
)

_T0, _T1, _T2 = 3.33333333333334091986e-01, 1.33333333333201242699e-01, 5.39682539762260521377e-02
_T3, _T4, _T5 = 2.18694882948595424599e-02, 8.86323982359930005737e-03, 3.59207910759131235356e-03
_T6, _T7, _T8 = 1.45620945432529025516e-03, 5.88041240820264096874e-04, 2.46463134818469906812e-04
_T9, _T10, _T11 = (
    7.81794442939557092300e-05,
    7.14072491382608190305e-05,
    -1.85586374855275456654e-05,
)
_T12 = 2.59073051863633712884e-05

_EIGHTH, _EIGHTH_REST = 7.85398163397448278999e-01, 3.06161699786838301793e-17


@kernel(inline=True)
def _sine(x: float, tail: float) -> float:
    """Return the sine of x + tail, which is within an eighth of a turn."""
    z = x * x
    w = z * z
    v = z * x
    r = _S2 + z * (_S3 + z * _S4) + z * w * (_S5 + z * _S6)
    return x - ((z * (0.5 * tail - v * r) - tail) - v * _S1)


@kernel(inline=True)
def _cosine(x: float, tail: float) -> float:
    """Return the cosine of x + tail, which is within an eighth of a turn."""
    z = x * x
    w = z * z
    r = z * (_C1 + z * (_C2 + z * _C3)) + w * w * (_C4 + z * (_C5 + z * _C6))
    half = 0.5 * z
    most = 1.0 - half
    return most + (((1.0 - most) - half) + (z * r - x * tail))


@kernel(double=True)
def sin(angle: float) -> float:
    """Return the sine of any angle [rad]."""
    quarters, x, tail = reduced(angle)
    value = _cosine(x, tail) if quarters & 1 else _sine(x, tail)
    return -value if quarters & 2 else value


@kernel(double=True)
def cos(angle: float) -> float:
    """Return the cosine of any angle [rad]."""
    quarters, x, tail = reduced(angle)
    value = _sine(x, tail) if quarters & 1 else _cosine(x, tail)
    return -value if (quarters + 1) & 2 else value


@kernel(double=True)
def sin_cos(angle: float) -> tuple[float, float]:
    """Return both, in little more time than one."""
    quarters, x, tail = reduced(angle)
    sine, cosine = _sine(x, tail), _cosine(x, tail)
    if quarters & 1:
        sine, cosine = cosine, -sine
    return (-sine, -cosine) if quarters & 2 else (sine, cosine)


@kernel(double=True)
def tan(angle: float) -> float:
    """Return the tangent of any angle [rad]."""
    if angle == 0.0:
        return angle  # with its sign
    quarters, x, tail = reduced(angle)
    if abs(x) >= 0.6744:
        return _tangent_near_an_eighth(x, tail, quarters & 1)
    value, rest = _tangent(x, tail)
    if quarters & 1 == 0:
        return value + rest
    total = value + rest
    high = leading(total)
    low = rest - (high - value)
    inverse = -1.0 / total
    inverse_high = leading(inverse)
    return inverse_high + inverse * ((1.0 + inverse_high * high) + inverse_high * low)


@kernel(inline=True)
def _tangent(x: float, tail: float) -> tuple[float, float]:
    """Return the tangent of x + tail, which is within an eighth of a turn, as a sum."""
    z = x * x
    w = z * z
    odd = _T1 + w * (_T3 + w * (_T5 + w * (_T7 + w * (_T9 + w * _T11))))
    even = z * (_T2 + w * (_T4 + w * (_T6 + w * (_T8 + w * (_T10 + w * _T12)))))
    s = z * x
    return x, (tail + z * (s * (odd + even) + tail)) + s * _T0


@kernel
def _tangent_near_an_eighth(x: float, tail: float, odd: int) -> float:
    """Return the tangent of x + tail, or -1 over it if `odd`, by its distance from an eighth."""
    sign = 1.0 if x > 0.0 else -1.0
    value, rest = _tangent((_EIGHTH - sign * x) + (_EIGHTH_REST - sign * tail), 0.0)
    total = value + rest
    one = 1.0 - 2.0 * odd
    return sign * (one - 2.0 * (value + (rest - total * total / (total + one))))
