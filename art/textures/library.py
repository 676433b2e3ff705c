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
from eyas.engine.world.build.materials import TEXTURES
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


def painted_textures() -> dict[str, NDArray[np.uint8]]:
    """Return every texture of `eyas.engine.world.build.materials.TEXTURES`, always the same bytes.

    Each is sRGB and alpha, shape (256, 256, 4), and repeats without a seam. Row 0 of an array is
    the **top** of the tile, v = 1: code that samples with v upwards flips the rows. Alpha is 255
    except for the holes of `leaves`, the glass of facades, people and `cloth`, where it is 0.
    """
    return {name: PAINTERS[name]() for name in TEXTURES}


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
