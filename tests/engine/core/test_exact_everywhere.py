"""What decides anything is computed by functions that are the same on every processor.

numpy picks its loops by the features of the processor. `numpy.lib.introspect.opt_func_info()` tells
which: in numpy 2.4 those of sin, cos, tan, their inverses, the hyperbolic functions, exp, log,
power and cbrt differ in their last bits, because AVX-512, AVX2 and the C library each bring their
own; hypot is the C library's, which picks by the processor too. Python's `math` and `**` of floats
call that library as well; Python's own hypot has changed between versions. Products of matrices,
`dot`, `convolve` and most of `linalg` go to BLAS and LAPACK, which add in an order of their own;
`einsum` fuses on some machines. Products of complex numbers are fused where the processor can.
`argsort` sorts by AVX-512 or AVX2 where it may leave the order of equals open.

The same everywhere: + - * /, sqrt, square, abs, sign, floor, ceil, rint, round, minimum, maximum,
clip, comparisons and mod, since IEEE 754 leaves nothing open there, however many numbers a loop
takes at once; add.reduce, sum, mean, std, cumsum, prod, diff, gradient, cross, outer, interp,
linspace, average and quantile, which consist of these in a fixed order (sums by blocks of 8 and
128); frexp and copysign; sort, whose values have one order only, and stable sorts;
`linalg.norm` with an axis and without an order, a square root of a sum of squares. Of random
numbers those from a uniform distribution and whole numbers.
`fft` is compiled once for all processors, but not the same in numpy 1 and 2.

In kernels a power with a whole number written out is a product; all else there is as in Python.
"""

import ast
from pathlib import Path

import pytest

import eyas

ROOT = Path(eyas.__file__).parent

ELSEWHERE = (
    *("benchmark/plots", "cli/", "dat/webots/", "demo/", "learning/", "maps/gallery/"),
    *("maps/programs/", "maps/traffic/", "robotics/fitting/", "robotics/serv"),
)
"""They show, measure or learn; what they record is made by the rooms below them."""

ALLOWED = {
    "lanes/exact.py": "takes their place",
    "benchmark/policies/action_choice.py": "actions' shares from networks' scores, which BLAS made",
    "benchmark/policies/tracker/detector.py: np.exp": "the same of places",
    "engine/core/bounds.py: np.vdot": "whether numbers are looked at one by one; none changes",
    "engine/sim/stepper.py: np.vdot": "the same",
    "engine/render/textures/fields.py: np.fft.rfft2": "not by processor; becomes bytes of textures",
    "engine/render/textures/fields.py: np.fft.irfft2": "the same",
}

BY_PROCESSOR = {
    *(
        "sin",
        "cos",
        "tan",
        "arcsin",
        "arccos",
        "arctan",
        "arctan2",
        "asin",
        "acos",
        "atan",
        "atan2",
    ),
    *("sinh", "cosh", "tanh", "arcsinh", "arccosh", "arctanh", "asinh", "acosh", "atanh", "sinc"),
    *("exp", "exp2", "expm1", "log", "log2", "log10", "log1p", "logaddexp", "logaddexp2"),
    *("power", "pow", "float_power", "cbrt", "hypot", "dist", "angle", "logspace", "geomspace"),
    *("gamma", "lgamma", "erf", "erfc", "i0"),
    *(
        "dot",
        "vdot",
        "inner",
        "matmul",
        "matvec",
        "vecmat",
        "vecdot",
        "tensordot",
        "einsum",
        "kron",
    ),
    *("convolve", "correlate", "cov", "corrcoef", "polyfit", "roots", "sumprod"),
    *("argpartition", "fft"),
}
"""Of numpy and `math`."""

SAFE = {"np.linalg.norm", "np.fft.fftfreq", "np.fft.rfftfreq"}

METHODS = {"dot", "argpartition"}

DRAWN = {
    *("normal", "standard_normal", "lognormal", "multivariate_normal", "exponential", "gamma"),
    *("standard_exponential", "standard_gamma", "beta", "chisquare", "vonmises", "weibull"),
    *("laplace", "logistic", "gumbel", "pareto", "rayleigh", "standard_t", "triangular"),
}
"""Of a generator of random numbers."""


class Finder(ast.NodeVisitor):
    """Collects what a file has that differs between processors: line and text."""

    def __init__(self) -> None:
        self.found: list[tuple[int, str]] = []
        self._kernel = False

    def visit_FunctionDef(self, node):
        before = self._kernel
        self._kernel = before or any("kernel" in ast.unparse(d) for d in node.decorator_list)
        self.generic_visit(node)
        self._kernel = before

    def visit_BinOp(self, node):
        if isinstance(node.op, ast.MatMult):
            self._note(node)
        if isinstance(node.op, ast.Pow) and not self._is_exact(node):
            self._note(node)
        self.generic_visit(node)

    def visit_AugAssign(self, node):
        if isinstance(node.op, (ast.MatMult, ast.Pow)):
            self._note(node)
        self.generic_visit(node)

    def visit_Attribute(self, node):
        text = ast.unparse(node)
        module, *names = text.split(".")
        if module not in ("np", "numpy", "math", "cmath") or "(" in text:
            self.generic_visit(node)
        elif module == "cmath" or (names[0] in BY_PROCESSOR | {"linalg"} and text not in SAFE):
            self._note(node)

    def visit_Call(self, node):
        name = node.func.attr if isinstance(node.func, ast.Attribute) else ast.unparse(node.func)
        words = {word.arg: ast.unparse(word.value) for word in node.keywords}
        own = isinstance(node.func, ast.Attribute) and "." not in ast.unparse(node.func.value)
        numpy = own and ast.unparse(node.func.value) in ("np", "numpy", "math", "exact")
        unstable = name == "argsort" and words.get("kind") != "'stable'"
        whole = ast.unparse(node.func) == "np.linalg.norm" and (
            "axis" not in words or "ord" in words
        )
        method = isinstance(node.func, ast.Attribute) and not numpy and name in METHODS | DRAWN
        if unstable or whole or method or ast.unparse(node.func) == "pow":
            self._note(node)
        self.generic_visit(node)

    def visit_ImportFrom(self, node):
        room, *inside = (node.module or "").split(".")
        names = {alias.name for alias in node.names}
        if room == "cmath" or (room in ("math", "numpy") and names & (BY_PROCESSOR | {"linalg"})):
            self._note(node)
        elif room == "numpy" and inside in (["linalg"], ["fft"]):
            self._note(node)

    def visit_Constant(self, node):
        if isinstance(node.value, complex):
            self._note(node)

    def _is_exact(self, node):
        exponent = node.right
        whole = isinstance(exponent, ast.Constant) and isinstance(exponent.value, int)
        base = node.left.value if isinstance(node.left, ast.Constant) else None
        if isinstance(exponent, ast.UnaryOp):  # a constant such as 2.0**-53
            return base == 2 and isinstance(exponent.operand, ast.Constant)
        return whole and (self._kernel or isinstance(base, int) or base == 2.0)

    def _note(self, node):
        self.found.append((node.lineno, ast.unparse(node)))


def found_in(text):
    """Return what a source has that differs between processors."""
    finder = Finder()
    finder.visit(ast.parse(text))
    return finder.found


def test_what_decides_is_the_same_on_every_processor():
    wrong, used = [], set()
    for path in sorted(ROOT.rglob("*.py")):
        name = path.relative_to(ROOT).as_posix()
        if name.startswith(ELSEWHERE):
            continue
        for line, text in found_in(path.read_text()):
            excuse = next((key for key in (name, f"{name}: {text}") if key in ALLOWED), None)
            if excuse is None:
                wrong.append(f"src/eyas/{name}:{line}: {text}")
            used.add(excuse)
    assert wrong == [], "take eyas.lanes.exact instead, in kernels eyas.lanes.elementary"
    assert set(ALLOWED) <= used, "these exceptions are not needed any more"


@pytest.mark.parametrize(
    "text",
    [
        "x = a @ b", "a @= b", "np.sin(x)", "f = np.cos", "numpy.exp(x)", "math.tan(x)",
        "a.dot(b)", "np.linalg.norm(v)", "np.linalg.norm(v, ord=1, axis=1)", "np.linalg.det(m)",
        "x**2", "2.5**0.5", "x**0.5", "x **= 2", "pow(x, y)", "np.einsum('ij,j', a, b)",
        "np.argsort(x)", "x.argsort()", "np.argpartition(x, 2)", "rng.normal()", "np.dot(a, b)",
        "self.rng.lognormal(0.0, 1.0)", "from math import sin", "from numpy.linalg import inv",
        "x + 1j * y", "cmath.exp(x)", "np.convolve(a, b)", "np.fft.rfft2(x)",
        "@kernel\ndef f(x):\n    return x**0.5", "@kernel\ndef f(x):\n    return math.sin(x)",
    ],
)  # fmt: skip
def test_what_differs_between_processors_is_found(text):
    assert len(found_in(text)) == 1


@pytest.mark.parametrize(
    "text",
    [
        "a * b + np.sqrt(c)", "np.square(x)", "np.linalg.norm(v, axis=1).max()", "2**31 - 1",
        "2.0**-53", "np.argsort(x, kind='stable')", "np.sort(x)", "exact.sin(x)", "f(**words)",
        "exact.normal(rng, 0.0, 1.0)", "rng.uniform(0.0, 1.0)", "exact.dot(a, b)", "math.sqrt(x)",
        "@kernel\ndef f(x):\n    return x**2", "@kernel\ndef f(x):\n    return elementary.sin(x)",
    ],
)  # fmt: skip
def test_what_is_the_same_everywhere_is_allowed(text):
    assert found_in(text) == []
