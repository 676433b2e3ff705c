"""COLLADA files."""

import numpy as np
import pytest

from eyas.engine.core.errors import EyasError
from eyas.engine.custom.config import CustomConfig
from eyas.engine.custom.mesh_file import loaded, read_mesh

trimesh = pytest.importorskip("trimesh")
pytest.importorskip("collada")


@pytest.fixture
def box(tmp_path):
    def saved(up="Z_UP", metres=1.0):
        content = trimesh.creation.box((1.0, 2.0, 4.0)).export(file_type="dae").decode()
        head = f'<unit meter="{metres}" name="unit"/><up_axis>{up}</up_axis>'
        begin, end = content.index("<up_axis>"), content.index("</asset>")
        path = tmp_path / "box.dae"
        path.write_text(content[:begin] + head + content[end:])
        return path

    return saved


@pytest.mark.parametrize(("up", "size"), [("Z_UP", (1, 2, 4)), ("Y_UP", (4, 1, 2))])
def test_the_axis_that_is_up_and_the_unit_are_the_file_s(box, up, size):
    path = box(up, 0.5)
    assert loaded(CustomConfig(mesh=str(path))).size == pytest.approx(np.array(size) * 0.5)
    config = CustomConfig(mesh=str(path), up="z", scale=2.0)
    assert loaded(config).size == pytest.approx((1.0, 2.0, 4.0))


def test_nodes_that_show_each_other_again_and_again_are_refused(box):
    path = box()
    eight = [8 * f'<instance_node url="#n{k + 1}"/>' for k in range(20)]
    nodes = "".join(f'<node id="n{k}">{inside}</node>' for k, inside in enumerate(eight))
    text = path.read_text().replace(
        "<library_visual_scenes>", f"<library_nodes>{nodes}</library_nodes><library_visual_scenes>"
    )
    shown = '<node><instance_node url="#n0"/></node></visual_scene>'
    path.write_text(text.replace("</visual_scene>", shown))
    with pytest.raises(EyasError, match="it shows too much") as caught:
        read_mesh(path)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("text", "problem"),
    [
        ("<COLLADA>", "not XML"),
        ("<robot/>", "its content is not <COLLADA>"),
        ('<!DOCTYPE a [<!ENTITY b "c">]><COLLADA/>', "DOCTYPE"),
        ('<COLLADA><asset><unit meter="-1"/></asset></COLLADA>', "its unit is -1.0 m"),
    ],
)
def test_bad_files_are_told_in_one_line(tmp_path, text, problem):
    (tmp_path / "a.dae").write_text(text)
    with pytest.raises(EyasError, match=problem):
        read_mesh(tmp_path / "a.dae")
