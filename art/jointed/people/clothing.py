"""Places of clothes, skin and hair in the textures of people, see
`art.cars.regions`.

Folds, seams, pockets and faces are painted, so they cost no triangles at any level of detail. What
goes around a body runs from the middle of its back over its right side, its front and its left
side.
"""

from art.cars.regions import RAISED, Region
from eyas.engine.state.mesh import Material, Surface

TORSO = Region(4, 4, 252, 110)
"""Around a torso, from the hem to the neck: waist at .35, armpits at .7, shoulders at .85."""
HIPS = Region(4, 118, 252, 150)  # Around the upper end of trousers, from the crotch to the belt
SLEEVE = Region(4, 158, 124, 252)
"""Around an arm, from the wrist over the elbow (.5) to the shoulder; the body is on its right."""
LEG = Region(132, 158, 252, 252)
"""Around a leg, from the ankle over the knee (.5) to the hip; the other leg is on its right."""

FACE = Region(4, 4, 252, 110)  # Around a head, from the chin to the crown
SKIN = Region(4, 118, 124, 172)  # Bare limbs, around and upwards
NECK = Region(132, 118, 252, 172)  # A neck, in the shade of the chin above
HAIR = Region(4, 180, 252, 252)  # Around a head of hair, upwards
CLOTHES = ("plain", "striped", "checked", "jacket", "quilted", "coat")  # Cuts and patterns


def cloth(cut: str = "plain", tint: tuple[float, float, float] | None = None) -> Material:
    """Return cloth in the colour of the instance, or in one of its own, sRGB."""
    if tint is None:
        return Material(
            texture=f"clothes_{cut}", tint=(RAISED, RAISED, RAISED), surface=Surface.PAINT
        )
    return Material(texture=f"clothes_{cut}", tint=_raised(tint), surface=Surface.MATT)


def skin(tone: tuple[float, float, float] | None) -> Material:
    """Return skin of a tone, sRGB; None: in the colour of the instance."""
    if tone is None:
        return Material(texture="heads", tint=(RAISED, RAISED, RAISED), surface=Surface.PAINT)
    return Material(texture="heads", tint=_raised(tone), surface=Surface.MATT)


def hair() -> Material:
    """Return hair in the colour of the instance."""
    return Material(texture="heads", tint=(RAISED, RAISED, RAISED), surface=Surface.PAINT)


def _raised(tint: tuple[float, float, float]) -> tuple[float, float, float]:
    red, green, blue = tint
    return RAISED * red, RAISED * green, RAISED * blue
