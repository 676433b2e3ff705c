"""All textures, painted by formula: no picture of others has to be licensed.

What is painted here ships as data: after a change run `python -m art.ship textures`.
"""

import io
import zipfile
from collections.abc import Callable
from hashlib import sha256
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from art.textures import bodywork, facades, ground, land, people, plants, roofs, wear
from eyas.engine.render.textures.mipmap import linear
from eyas.engine.world.build.materials import TEXTURES
from eyas.lanes import exact
from eyas.maps.textures.shipped import FILE


def _plain() -> NDArray[np.uint8]:
    return np.full((256, 256, 4), 255, np.uint8)


def _cloth() -> NDArray[np.uint8]:
    """Return white; alpha 0 takes the gloss from paint."""
    cloth = _plain()
    cloth[..., 3] = 0
    return cloth


PAINTERS: dict[str, Callable[[], NDArray[np.uint8]]] = {
    "plain": _plain,
    "cloth": _cloth,
    "asphalt": ground.asphalt,
    "asphalt_light": ground.asphalt_light,
    "paving": ground.paving,
    "lawn": ground.lawn,
    "lawn_mown": ground.lawn_mown,
    "soil": ground.soil,
    "sand": land.sand,
    "crops": land.crops,
    "crops_ripe": land.crops_ripe,
    "crops_green": land.crops_green,
    "crops_yellow": land.crops_yellow,
    "crops_lilac": land.crops_lilac,
    "crops_tan": land.crops_tan,
    "dry_leaves": land.dry_leaves,
    "snow": land.snow,
    "clinker": land.clinker,
    "water": land.water,
    "paint": wear.paint,
    "asphalt_paint": wear.asphalt_paint,
    "asphalt_patch": wear.asphalt_patch,
    "asphalt_lane": wear.asphalt_lane,
    "asphalt_oil": wear.asphalt_oil,
    "manhole": wear.manhole,
    "concrete": facades.concrete,
    "bark": plants.bark,
    "leaves": plants.leaves,
    "foliage": plants.foliage,
    "pale_leaves": plants.pale_leaves,
    "pale_foliage": plants.pale_foliage,
    "roof_tiles": roofs.roof_tiles,
    "roof_terrace": roofs.roof_terrace,
    "roof_gravel": roofs.roof_gravel,
    "roof_membrane": roofs.roof_membrane,
    "bitumen": roofs.bitumen,
    "brick": facades.brick,
    "stone": facades.stone,
    "facade_concrete": facades.facade_concrete,
    "facade_brick": facades.facade_brick,
    "facade_plaster": facades.facade_plaster,
    "facade_stone": facades.facade_stone,
    "facade_office": facades.facade_office,
    "facade_glass": facades.facade_glass,
    "facade_highrise": facades.facade_highrise,
    "facade_old": facades.facade_old,
    "facade_bands": facades.facade_bands,
    "facade_red_white": facades.facade_red_white,
    "ground_shop": facades.ground_shop,
    "ground_lobby": facades.ground_lobby,
    **bodywork.PAINTERS,
    **people.PAINTERS,
}
"""The function that paints each texture of `eyas.engine.world.build.materials.TEXTURES`."""


ALBEDO: dict[str, tuple[float, float, float]] = {
    # Pavements, roofs: Pomerantz et al., Examples of cooler reflective streets (LBNL-49283, 2003):
    # asphalt .04 to .05 new, .12 to .2 worn; concrete .35 new, .2 to .3 worn. Akbari et al., Cool
    # colors and roofs (LBNL, 2005): bitumen .05 to .15, gravel .2, old clay .15 to .3, white
    # membranes .5 to .6 with a few years' dirt.
    "asphalt": (0.156, 0.152, 0.145),
    "asphalt_light": (0.215, 0.208, 0.195),
    "asphalt_patch": (0.100, 0.099, 0.096),
    "paving": (0.275, 0.248, 0.222),
    "concrete": (0.300, 0.288, 0.264),
    "stone": (0.335, 0.308, 0.262),
    "clinker": (0.165, 0.100, 0.078),
    "roof_tiles": (0.205, 0.116, 0.083),
    "roof_terrace": (0.190, 0.152, 0.126),
    "roof_gravel": (0.215, 0.205, 0.182),
    "roof_membrane": (0.480, 0.470, 0.440),
    "bitumen": (0.104, 0.103, 0.102),
    # White of road markings: luminance factor .3 (class B2) to .6 new (EN 1436).
    "paint": (0.520, 0.510, 0.485),
    # Plants and soils in visible light, where they are darker than in all of the sun's: Bowker et
    # al., Spectral reflectances of natural targets (NASA RP-1139, 1985): grass .05 to .12, soil .08
    # to .2, dry sand .3 to .4; rape in flower, stubble and ripe grain .2 to .3.
    "lawn": (0.080, 0.112, 0.033),
    "lawn_mown": (0.077, 0.112, 0.032),
    "soil": (0.152, 0.118, 0.080),
    "sand": (0.400, 0.330, 0.232),
    "dry_leaves": (0.088, 0.068, 0.046),
    "crops": (0.092, 0.104, 0.048),
    "crops_ripe": (0.250, 0.190, 0.092),
    "crops_green": (0.066, 0.090, 0.035),
    "crops_yellow": (0.240, 0.220, 0.058),
    "crops_lilac": (0.122, 0.106, 0.142),
    "crops_tan": (0.235, 0.190, 0.128),
}
"""Mean share of light that a texture reflects, of red, green and blue; of others, as painted."""

_LIKE = dict.fromkeys(("asphalt_paint", "asphalt_lane", "asphalt_oil", "manhole"), "asphalt")
"""Textures that lie in another's, and so are as much lighter or darker than painted as that is."""


def painted_texture(name: str) -> NDArray[np.uint8]:
    """Return a texture as light as `ALBEDO` says."""
    own, of = PAINTERS[name](), _LIKE.get(name, name)
    if of not in ALBEDO:
        return own
    mean = linear(PAINTERS[of]()[..., :3] / 255.0).mean(axis=(0, 1))
    light = np.clip(linear(own[..., :3] / 255.0) * (ALBEDO[of] / mean), 1e-6, 1.0)
    encoded = np.where(
        light <= 0.0031308, 12.92 * light, 1.055 * exact.power(light, 1 / 2.4) - 0.055
    )
    own[..., :3] = np.round(255.0 * encoded)
    if name == "asphalt_paint":
        painted = linear(wear.paint()[..., 1] / 255.0).mean()
        own[..., 3] = np.round(own[..., 3] * (ALBEDO["paint"][1] / painted))
    return own


def painted_textures() -> dict[str, NDArray[np.uint8]]:
    """Return every texture of `eyas.engine.world.build.materials.TEXTURES`, always the same bytes.

    Each is sRGB and alpha, shape (256, 256, 4), and repeats without a seam. Row 0 of an array is
    the **top** of the tile, v = 1: code that samples with v upwards flips the rows. Alpha is 255
    except for the holes of `leaves`, the glass of facades, people and `cloth`, where it is 0.
    """
    return {name: painted_texture(name) for name in TEXTURES}


def pack_textures() -> tuple[dict[Path, bytes], str]:
    """Return the file that ships, and the digest of its unpacked bytes."""
    painted = painted_textures()
    content = b"".join(painted[name].tobytes() for name in TEXTURES)
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w") as archive:
        for name in TEXTURES:
            picture = io.BytesIO()
            # `exact` keeps the colours of transparent pixels, which mip levels average.
            Image.fromarray(painted[name]).save(
                picture, "WEBP", lossless=True, exact=True, quality=75, method=6
            )
            archive.writestr(zipfile.ZipInfo(f"{name}.webp"), picture.getvalue())
    return {FILE: packed.getvalue()}, sha256(content).hexdigest()
