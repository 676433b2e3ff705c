"""A project of a map without scenery, and its PROTOs as a reader has them."""

import pytest

from eyas.maps.formats.registry import MapExport, export

from .grammar import Reader

MAP = "farmland-bare"
WORLD = f"{MAP}-dusk.wbt"


@pytest.fixture(scope="session")
def project(tmp_path_factory):
    """The folder of the project."""
    root = tmp_path_factory.mktemp("webots")
    lines = list(export("webots", root, MapExport(MAP, weather="dusk")))
    folder = root / "Webots_Simulation" / "traffic_project"
    assert lines[0] == str(folder / "worlds" / WORLD)
    return folder


@pytest.fixture(scope="session")
def protos(project):
    paths = sorted((project / "protos").glob("*.proto"))
    read = [Reader(path.read_text()).proto() for path in paths]
    assert [proto.name for proto in read] == [path.stem for path in paths]
    return read


@pytest.fixture(scope="session")
def told(project, protos):
    """The world: its nodes, and the paths of its PROTOs and of those that may be imported."""
    return Reader((project / "worlds" / WORLD).read_text(), protos).world()
