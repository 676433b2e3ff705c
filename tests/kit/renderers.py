from collections.abc import Callable

import numpy as np
import pytest

from eyas.engine.render.pack.geometry import build_geometry
from eyas.engine.render.renderer import CpuRenderer, build_renderer
from eyas.engine.state.draw import DrawList, PartLibrary, Picture, Views
from eyas.engine.state.lighting import Lighting
from eyas.engine.state.scene import Scene

from .small_city import DAY, car_parts, city_scene, city_traffic, textures


@pytest.fixture(scope="session")
def images():
    return textures()


@pytest.fixture(scope="session")
def renderer_of(tmp_path_factory, images) -> Callable[..., CpuRenderer]:
    folder = tmp_path_factory.mktemp("shadows")

    def build(
        scene: Scene, parts: PartLibrary | None = None, lighting: Lighting = DAY
    ) -> CpuRenderer:
        geometry = build_geometry(scene, parts or PartLibrary(()), images)
        return build_renderer(scene, geometry, lighting, cache=folder)

    return build


@pytest.fixture(scope="session")
def city(renderer_of) -> tuple[CpuRenderer, DrawList]:
    return renderer_of(city_scene(), car_parts()), city_traffic(2)


@pytest.fixture(scope="session")
def drawn() -> Callable[..., Picture]:
    def draw(
        renderer: CpuRenderer,
        views: Views,
        draw_list: DrawList | None = None,
        size: tuple[int, int] = (96, 128),
        samples: int = 1,
    ) -> Picture:
        wanted = {"depth": True, "object_id": True, "subject": True}
        picture = Picture.create(len(views.position), *size, **wanted)
        for array in (picture.rgb, picture.depth, picture.object_id):
            array[:] = 77  # what is not written shows
        draw_list = draw_list or DrawList.create(int(np.max(views.world)) + 1, 1)
        renderer.draw(views, draw_list, picture, samples)
        return picture

    return draw
