"""Heads of people: skull with a face, hair, hats; their origin is at the lower end of the neck.

Skin has the colour of one instance, hair or what covers it that of another.
"""

from collections.abc import Callable
from functools import cache

from art.jointed.people.clothing import FACE, HAIR, NECK, SKIN, TORSO, cloth, hair, skin
from art.jointed.people.person import Head
from art.jointed.people.surfaces import Row, wrapped
from art.parts import DETAILS, Shape
from eyas.engine.mesh.shell import Shell

_SIDES = (5, 7, 10)
_BARE = skin(None)

_CHIN = 0.07  # Height of the chin above the origin [m]

_SKULL: tuple[Row, ...] = (
    (0.000, 0.078, 0.010, 0.026), (0.022, 0.092, 0.040, 0.050), (0.050, 0.098, 0.062, 0.062),
    (0.085, 0.100, 0.080, 0.070), (0.125, 0.096, 0.093, 0.074), (0.152, 0.102, 0.097, 0.077),
    (0.190, 0.090, 0.094, 0.073), (0.222, 0.048, 0.058, 0.042), (0.234, 0.006, 0.008, 0.006),
)  # fmt: skip
"""Outlines of a head above the chin."""


def head_shape(shell: Shell, detail: int) -> None:
    """Add a bare head."""
    sides = _SIDES[detail]
    if detail:
        neck = [(-0.03, 0.056, 0.060, 0.060), (0.05, 0.050, 0.060, 0.056),
                (0.11, 0.045, 0.060, 0.054)]  # fmt: skip
        wrapped(shell, neck, (0.0, 0.6, 1.0), NECK, _BARE, sides=sides - 2, caps=False)
    lifted = [(z + _CHIN, 0.012 + ahead, back - 0.004, half) for z, ahead, back, half in _SKULL]
    wrapped(shell, lifted, [row[0] / 0.234 for row in _SKULL], FACE, _BARE, sides=sides)
    if detail == DETAILS[0]:
        _features(shell)


@cache
def hair_shape(head: Head) -> Shape:
    """Return what is on a head."""

    def shape(shell: Shell, detail: int) -> None:
        _COVERS[head](shell, _SIDES[detail], detail)

    return shape


def _features(shell: Shell) -> None:
    """Add a nose and ears."""
    z = _CHIN
    tip = (0.133, 0.0, z + 0.088)
    root, low = (0.110, 0.0, z + 0.130), (0.108, 0.0, z + 0.078)
    for side in (-1.0, 1.0):
        edge = (0.104, 0.017 * side, z + 0.084)
        faces = [(tip, root, edge), (tip, edge, low)]
        triangles = [face if side < 0 else face[::-1] for face in faces]
        uvs = FACE.at([0.5, 0.5, 0.5], [0.42, 0.5, 0.42])
        shell.triangles(triangles, _BARE, uvs=[uvs, uvs])
    ears = [(z + 0.082, 0.002, 0.014, 0.004), (z + 0.112, 0.016, 0.024, 0.01),
            (z + 0.145, 0.006, 0.022, 0.004)]  # fmt: skip
    for side in (-1.0, 1.0):
        ear = Shell()
        wrapped(ear, ears, (0.2, 0.5, 0.8), SKIN, _BARE, sides=4)
        mesh = ear.mesh()
        corners = mesh.positions[mesh.triangles] + [0.0, 0.076 * side, 0.0]
        shell.triangles(corners, _BARE, uvs=mesh.uvs[mesh.triangles])


def _hairy(shell: Shell, rows: list[Row], sides: int) -> None:
    low, high = rows[0][0], rows[-1][0]
    ups = [(row[0] - low) / (high - low) for row in rows]
    lifted = [(z + _CHIN, ahead, back, half) for z, ahead, back, half in rows]
    wrapped(shell, lifted, ups, HAIR, hair(), sides=sides)


_TOP: list[Row] = [
    (0.168, 0.108, 0.112, 0.087), (0.204, 0.102, 0.107, 0.083), (0.234, 0.066, 0.073, 0.055),
    (0.248, 0.006, 0.008, 0.006),
]  # fmt: skip
"""Hair above the hairline."""


def _short(shell: Shell, sides: int, detail: int) -> None:
    _hairy(shell, [(0.045, -0.030, 0.072, 0.056), (0.085, -0.012, 0.100, 0.077),
                   (0.135, 0.030, 0.108, 0.085), *_TOP], sides)  # fmt: skip


def _long(shell: Shell, sides: int, detail: int) -> None:
    _hairy(
        shell,
        [
            (-0.17, -0.055, 0.130, 0.085),
            (-0.09, -0.035, 0.132, 0.098),
            (0.03, 0.000, 0.120, 0.094),
            (0.12, 0.022, 0.118, 0.092),
            *_TOP,
        ],
        sides,
    )


def _bob(shell: Shell, sides: int, detail: int) -> None:
    _hairy(shell, [(-0.01, 0.004, 0.105, 0.088), (0.03, 0.02, 0.122, 0.102),
                   (0.11, 0.03, 0.120, 0.097), *_TOP], sides)  # fmt: skip


def _bun(shell: Shell, sides: int, detail: int) -> None:
    _short(shell, sides, detail)
    shell.ball(
        (-0.115, 0.0, _CHIN + 0.185),
        (0.048, 0.05, 0.048),
        hair(),
        rows=2 + detail,
        sides=max(sides - 4, 4),
    )


def _tail(shell: Shell, sides: int, detail: int) -> None:
    _short(shell, sides, detail)
    fall = [
        (-0.13, -0.115, 0.135, 0.014),
        (-0.05, -0.09, 0.150, 0.032),
        (0.08, -0.08, 0.150, 0.034),
        (0.16, -0.06, 0.125, 0.022),
    ]
    _hairy(shell, fall, max(sides - 4, 5))


def _bald(shell: Shell, sides: int, detail: int) -> None:
    _hairy(shell, [(0.045, -0.030, 0.066, 0.050), (0.085, -0.012, 0.090, 0.075),
                   (0.135, -0.005, 0.099, 0.080), (0.165, -0.03, 0.094, 0.07)], sides)  # fmt: skip


def _covered(shell: Shell, rows: list[Row], sides: int) -> None:
    lifted = [(z + _CHIN, ahead, back, half) for z, ahead, back, half in rows]
    ups = [0.1 + 0.12 * k / len(rows) for k in range(len(rows))]
    wrapped(shell, lifted, ups, TORSO, cloth(), sides=sides)


def _nape(shell: Shell, sides: int) -> None:
    """Add short dark hair below a cap or hat."""
    rows = [
        (0.045, -0.030, 0.068, 0.052),
        (0.085, -0.012, 0.097, 0.077),
        (0.15, -0.01, 0.101, 0.08),
    ]
    lifted = [(z + _CHIN, ahead, back, half) for z, ahead, back, half in rows]
    wrapped(shell, lifted, (0.0, 0.5, 1.0), TORSO, cloth(tint=(0.2, 0.15, 0.12)), sides=sides)


def _cap(shell: Shell, sides: int, detail: int) -> None:
    _nape(shell, sides)
    _covered(shell, [(0.146, 0.112, 0.108, 0.086), (0.190, 0.106, 0.106, 0.085),
                     (0.226, 0.080, 0.086, 0.066), (0.246, 0.035, 0.042, 0.030),
                     (0.25, 0.004, 0.005, 0.004)], sides)  # fmt: skip
    if detail:
        _covered(shell, [(0.148, 0.175, 0.0, 0.068), (0.158, 0.172, 0.0, 0.066)], sides)


def _hat(shell: Shell, sides: int, detail: int) -> None:
    _nape(shell, sides)
    _covered(shell, [(0.152, 0.165, 0.160, 0.140), (0.162, 0.165, 0.160, 0.140)], sides)
    _covered(shell, [(0.158, 0.110, 0.108, 0.088), (0.215, 0.104, 0.102, 0.083),
                     (0.254, 0.085, 0.085, 0.062)], sides)  # fmt: skip


def _beanie(shell: Shell, sides: int, detail: int) -> None:
    _nape(shell, sides)
    _covered(shell, [(0.128, 0.112, 0.112, 0.089), (0.172, 0.114, 0.114, 0.091),
                     (0.173, 0.108, 0.109, 0.086), (0.222, 0.086, 0.092, 0.070),
                     (0.25, 0.042, 0.048, 0.036), (0.258, 0.004, 0.005, 0.004)], sides)  # fmt: skip


def _hood(shell: Shell, sides: int, detail: int) -> None:
    _covered(shell, [(-0.10, 0.03, 0.105, 0.105), (-0.02, 0.045, 0.118, 0.100),
                     (0.06, 0.055, 0.128, 0.104), (0.15, 0.08, 0.130, 0.104),
                     (0.195, 0.118, 0.122, 0.098), (0.232, 0.096, 0.098, 0.074),
                     (0.255, 0.045, 0.05, 0.036), (0.26, 0.004, 0.005, 0.004)], sides)  # fmt: skip


_COVERS: dict[Head, Callable[[Shell, int, int], None]] = {
    Head.SHORT: _short,
    Head.LONG: _long,
    Head.BUN: _bun,
    Head.TAIL: _tail,
    Head.BOB: _bob,
    Head.CAP: _cap,
    Head.HAT: _hat,
    Head.BEANIE: _beanie,
    Head.HOOD: _hood,
    Head.BALD: _bald,
}
