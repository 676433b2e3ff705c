"""panda3d's software renderer: the same scene, without shadows, which it does not support."""

import numpy as np
from city import Batch, City
from panda3d.core import (
    AmbientLight,
    Camera,
    CullFaceAttrib,
    DirectionalLight,
    Fog,
    FrameBufferProperties,
    Geom,
    GeomNode,
    GeomTriangles,
    GeomVertexData,
    GeomVertexFormat,
    GraphicsEngine,
    GraphicsOutput,
    GraphicsPipe,
    GraphicsPipeSelection,
    LMatrix4,
    MatrixLens,
    NodePath,
    SamplerState,
    Texture,
    WindowProperties,
    loadPrcFileData,
)

loadPrcFileData("", "load-display p3tinydisplay\naudio-library-name null\nsync-video 0\n")


class Peer:
    """Draws all views into one picture, a tile each."""

    name = "panda3d, software pipe (no shadows)"

    def __init__(self, city: City, side: int) -> None:
        self._root = NodePath("root")
        self._images = [_image(layer) for layer in city.textures]
        self._add(city.static, self._root, None)
        for batch, poses, paint in zip(city.parts, city.slots, city.slot_colours, strict=True):
            for pose, colour in zip(poses, paint, strict=True):
                node = self._root.attachNewNode("part")
                self._add(batch, node, colour)
                rows = np.vstack([pose, [0, 0, 0, 1]]).T.ravel().tolist()
                node.setMat(LMatrix4(*rows))
        self._light(city)
        self._target(city, side)

    def _add(self, batch: Batch, parent: NodePath, paint: np.ndarray | None) -> None:
        """Add a node for each square and texture, as panda3d draws one texture at a time."""
        square = np.searchsorted(batch.first, np.arange(0, len(batch.layers), 3), side="right")
        keys = square * 1000 + batch.layers[::3]
        for key in np.unique(keys):
            corners = (3 * np.flatnonzero(keys == key)[:, None] + np.arange(3)).ravel()
            node = parent.attachNewNode(_geometry(batch, corners, paint))
            node.setTexture(self._images[int(key % 1000)])

    def _light(self, city: City) -> None:
        ambient = AmbientLight("sky")
        ambient.setColor((0.45, 0.5, 0.55, 1))
        self._root.setLight(self._root.attachNewNode(ambient))
        sun = DirectionalLight("sun")
        sun.setColor((0.8, 0.77, 0.7, 1))
        node = self._root.attachNewNode(sun)
        node.setPos(*[float(300 * k) for k in city.sun])
        node.lookAt(0, 0, 0)
        self._root.setLight(node)
        fog = Fog("air")
        fog.setColor(0.66, 0.71, 0.77)
        fog.setExpDensity(1 / 4000)
        self._root.setFog(fog)
        self._root.setAttrib(CullFaceAttrib.make(CullFaceAttrib.MCullClockwise))

    def _target(self, city: City, side: int) -> None:
        count = len(city.views.position)
        across = int(np.ceil(np.sqrt(count)))
        self._engine = GraphicsEngine.getGlobalPtr()
        pipe = GraphicsPipeSelection.getGlobalPtr().makeDefaultPipe()
        asked = FrameBufferProperties()
        asked.setRgbaBits(8, 8, 8, 8)
        asked.setDepthBits(24)
        size = WindowProperties.size(across * side, across * side)
        window = self._engine.makeOutput(pipe, "views", 0, asked, size, GraphicsPipe.BFRefuseWindow)
        self._picture = Texture()
        window.addRenderTexture(self._picture, GraphicsOutput.RTMCopyRam, GraphicsOutput.RTPColor)
        window.setClearColor((0.66, 0.71, 0.77, 1))
        for k in range(count):
            x, y = k % across / across, k // across / across
            region = window.makeDisplayRegion(x, x + 1 / across, y, y + 1 / across)
            region.setCamera(self._camera(city, k))

    def _camera(self, city: City, k: int) -> NodePath:
        views = city.views
        assert views.vertical_field_of_view is not None
        lens = MatrixLens()
        across = 1 / np.tan(views.field_of_view / 2)
        up = 1 / np.tan(views.vertical_field_of_view / 2)
        near, far = 0.3, 3000.0
        a, b = (far + near) / (far - near), -2 * far * near / (far - near)
        # Row vectors; panda3d's camera looks along y with z up, which `MatrixLens` keeps.
        lens.setUserMat(LMatrix4(across, 0, 0, 0, 0, 0, a, 1, 0, up, 0, 0, 0, 0, b, 0))
        node = self._root.attachNewNode(Camera("camera", lens))
        forward, left, upward = views.rotation[k].T
        rows = [[*-left, 0], [*forward, 0], [*upward, 0], [*views.position[k], 1]]
        node.setMat(LMatrix4(*np.array(rows).ravel().tolist()))
        return node

    def draw(self) -> None:
        """Draw all views and read them back into `rgb`."""
        self._engine.renderFrame()
        height, width = self._picture.getYSize(), self._picture.getXSize()
        data = np.frombuffer(self._picture.getRamImage(), np.uint8)
        self.rgb = data.reshape(height, width, 4)[..., 2::-1].copy()


def _image(layer: np.ndarray) -> Texture:
    texture = Texture()
    height, width = layer.shape[:2]
    texture.setup2dTexture(width, height, Texture.TUnsignedByte, Texture.FRgb)
    texture.setRamImage(np.ascontiguousarray(layer[::-1, :, 2::-1]).tobytes())
    texture.setMinfilter(SamplerState.FTLinearMipmapLinear)
    return texture


def _geometry(batch: Batch, corners: np.ndarray, paint: np.ndarray | None) -> GeomNode:
    colour = np.ones((len(corners), 4))
    colour[:, :3] = batch.colours[corners]
    if paint is not None:
        colour[:, :3] *= np.where(batch.painted[corners, None], paint, 1.0)
    data = GeomVertexData("mesh", GeomVertexFormat.getV3n3c4t2(), Geom.UHStatic)
    data.uncleanSetNumRows(len(corners))
    kind = [("v", "<f4", 3), ("n", "<f4", 3), ("c", "u1", 4), ("t", "<f4", 2)]
    table = np.zeros(len(corners), np.dtype(kind))
    table["v"], table["n"] = batch.positions[corners], batch.normals[corners]
    table["c"], table["t"] = np.round(255 * colour), batch.uvs[corners]
    memoryview(data.modifyArray(0)).cast("B")[:] = table.tobytes()
    triangles = GeomTriangles(Geom.UHStatic)
    triangles.addNextVertices(len(corners))
    geometry = Geom(data)
    geometry.addPrimitive(triangles)
    node = GeomNode("mesh")
    node.addGeom(geometry)
    return node
