"""Materials of OpenUSD: UsdPreviewSurface with textures."""

from typing import TYPE_CHECKING, Any

from eyas.engine.state.mesh import Material, Surface
from eyas.maps.exports.gltf.file import PLAIN, light_factors

if TYPE_CHECKING:
    from pxr import Sdf

__all__ = ["Materials"]

_SHINING = {Surface.LAMP, Surface.SIGNAL}
_ROUGH = {Surface.WATER: 0.1, Surface.GLASS: 0.1, Surface.PAINT: 0.35}


class Materials:
    """Adds materials to a layer; call it within an `Sdf.ChangeBlock`.

    Attributes:
        textures: Names of the textures that they show.

    Args:
        layer: The layer.
        folder: Name of the folder of the textures, beside the layer's file.
    """

    def __init__(self, layer: "Sdf.Layer", folder: str) -> None:
        self.textures: set[str] = set()
        self._layer, self._folder = layer, folder

    def add(self, path: str, material: Material) -> None:
        """Add a material at a path."""
        from pxr import Gf, Sdf

        made = Sdf.CreatePrimInLayer(self._layer, path)
        made.specifier, made.typeName = Sdf.SpecifierDef, "Material"
        out = Sdf.AttributeSpec(made, "outputs:surface", Sdf.ValueTypeNames.Token)
        out.connectionPathList.explicitItems = [Sdf.Path(f"{path}/surface.outputs:surface")]
        tint, types = light_factors(material), Sdf.ValueTypeNames
        inputs: dict[str, tuple[Any, Any]] = {
            "diffuseColor": (types.Color3f, Gf.Vec3f(*tint)),
            "roughness": (types.Float, _ROUGH.get(material.surface, 1.0)),
        }
        if material.surface in _SHINING:
            inputs["emissiveColor"] = types.Color3f, Gf.Vec3f(*tint)
        if material.texture != PLAIN:
            self._texture(path, material, tint)
            inputs["diffuseColor"] = types.Color3f, Sdf.Path(f"{path}/texture.outputs:rgb")
        if material.surface is Surface.FOLIAGE and material.texture != PLAIN:
            inputs["opacity"] = types.Float, Sdf.Path(f"{path}/texture.outputs:a")
            inputs["opacityThreshold"] = types.Float, 0.5
        outputs = {"surface": types.Token}
        self._shader(f"{path}/surface", "UsdPreviewSurface", inputs, outputs)

    def _texture(self, path: str, material: Material, tint: list[float]) -> None:
        """Add the shaders that read a texture, whose colours and alpha a material takes."""
        from pxr import Gf, Sdf

        types = Sdf.ValueTypeNames
        self.textures.add(material.texture)
        place = {"varname": (types.String, "st")}
        self._shader(f"{path}/st", "UsdPrimvarReader_float2", place, {"result": types.Float2})
        file = Sdf.AssetPath(f"./{self._folder}/{material.texture}.png")
        inputs = {
            "file": (types.Asset, file),
            "st": (types.Float2, Sdf.Path(f"{path}/st.outputs:result")),
            "wrapS": (types.Token, "repeat"),
            "wrapT": (types.Token, "repeat"),
            "sourceColorSpace": (types.Token, "sRGB"),
            "scale": (types.Float4, Gf.Vec4f(*tint, 1.0)),
        }
        outputs = {"rgb": types.Float3, "a": types.Float}
        self._shader(f"{path}/texture", "UsdUVTexture", inputs, outputs)

    def _shader(
        self, path: str, kind: str, inputs: dict[str, tuple[Any, Any]], outputs: dict[str, Any]
    ) -> None:
        """Add a shader; an input is a value, or the path of what it is connected to."""
        from pxr import Sdf

        made = Sdf.CreatePrimInLayer(self._layer, path)
        made.specifier, made.typeName = Sdf.SpecifierDef, "Shader"
        token, uniform = Sdf.ValueTypeNames.Token, Sdf.VariabilityUniform
        Sdf.AttributeSpec(made, "info:id", token, uniform).default = kind
        for name, (type_, value) in inputs.items():
            given = Sdf.AttributeSpec(made, f"inputs:{name}", type_)
            if isinstance(value, Sdf.Path):
                given.connectionPathList.explicitItems = [value]
            else:
                given.default = value
        for name, type_ in outputs.items():
            Sdf.AttributeSpec(made, f"outputs:{name}", type_)
