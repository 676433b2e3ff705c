"""What people have along: bags and prams."""

from functools import cache

from art.jointed.outlines import cylinder
from art.jointed.people.clothing import LEG, TORSO, cloth
from art.jointed.people.person import FOREARM, Build, Carried
from art.jointed.people.surfaces import Row, wrapped
from art.jointed.people.trunks import straps
from art.parts import Shape
from eyas.engine.mesh.shell import Shell

_DARK = cloth(tint=(0.12, 0.12, 0.13))


@cache
def carried_shape(carried: Carried, build: Build) -> Shape:
    """Return a thing in the colour of the instance, in the frame of what holds it: the torso, the
    right forearm, or, of a pram, the ground.
    """

    def shape(shell: Shell, detail: int) -> None:
        _SHAPES[carried](shell, detail)
        if detail and carried in (Carried.BACKPACK, Carried.SHOULDER_BAG):
            straps(shell, build, carried)

    return shape


def _backpack(shell: Shell, detail: int) -> None:
    rows: list[Row] = [
        (0.06, -0.09, 0.215, 0.13),
        (0.09, -0.08, 0.25, 0.15),
        (0.25, -0.08, 0.26, 0.155),
        (0.40, -0.08, 0.235, 0.14),
        (0.47, -0.08, 0.18, 0.11),
    ]
    wrapped(
        shell,
        rows,
        (0.0, 0.1, 0.4, 0.7, 0.85),
        TORSO,
        cloth("quilted" if detail else "plain"),
        sides=(5, 8, 10)[detail],
        box=0.5,
    )
    if detail:
        pocket: list[Row] = [
            (0.09, -0.2, 0.28, 0.11),
            (0.12, -0.2, 0.295, 0.115),
            (0.24, -0.2, 0.285, 0.11),
        ]
        wrapped(shell, pocket, (0.15, 0.2, 0.3), TORSO, cloth(), sides=8, box=0.5)


def _shoulder_bag(shell: Shell, detail: int) -> None:
    shell.box((-0.13, -0.28, -0.2), (0.13, -0.19, 0.03), cloth(), taper=0.012)


def _shopping_bag(shell: Shell, detail: int) -> None:
    z = -FOREARM - 0.11
    low, high = (-0.13, -0.06, z - 0.36), (0.13, 0.06, z - 0.1)
    shell.box(low, high, cloth(), taper=-0.012)
    if detail:
        for y in (-0.03, 0.03):
            path = [(-0.07, y, z - 0.11), (0.0, 0.3 * y, z + 0.02), (0.07, y, z - 0.11)]
            shell.tube(path, (0.006, 0.006, 0.006), _DARK, sides=3)


def _pram(shell: Shell, detail: int) -> None:
    """Add a pram: a tub with a hood on four wheels; the handle is behind."""
    sides = (5, 8, 10)[detail]
    tub: list[Row] = [(0.48, 0.30, 0.26, 0.16), (0.55, 0.37, 0.32, 0.20), (0.76, 0.40, 0.34, 0.22)]
    wrapped(shell, tub, (0.0, 0.2, 0.4), TORSO, cloth("quilted"), sides=sides, box=0.6)
    if detail:
        inside: list[Row] = [(0.762, 0.36, 0.30, 0.19), (0.775, 0.30, 0.1, 0.17)]
        wrapped(shell, inside, (0.1, 0.2), LEG, cloth(tint=(0.8, 0.78, 0.74)), sides=sides, box=0.6)
    hood: list[Row] = [
        (0.74, 0.40, -0.05, 0.23),
        (0.90, 0.38, -0.06, 0.22),
        (1.0, 0.27, -0.1, 0.15),
    ]
    wrapped(shell, hood, (0.2, 0.5, 0.7), TORSO, cloth("quilted"), sides=sides, box=0.4)
    for x in (-0.26, 0.28):
        for y in (-0.22, 0.22):
            cylinder(shell, (x, y, 0.14), 0.14, 0.04, _DARK, (5, 7, 12)[detail])
    for y in (-0.2, 0.2):
        frame = [(0.28, y, 0.16), (-0.26, y, 0.62), (-0.5, y, 1.0)]
        shell.tube(frame, (0.013, 0.013, 0.013), _DARK, sides=4)
        shell.tube([(-0.26, y, 0.16), (0.2, y, 0.55)], (0.013, 0.013), _DARK, sides=4)
    shell.tube([(-0.5, 0.2, 1.0), (-0.5, -0.2, 1.0)], (0.016, 0.016), _DARK, sides=4)


_SHAPES = {
    Carried.BACKPACK: _backpack,
    Carried.SHOULDER_BAG: _shoulder_bag,
    Carried.SHOPPING_BAG: _shopping_bag,
    Carried.PRAM: _pram,
}
