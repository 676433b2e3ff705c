"""A map as OpenUSD: shapes, materials, classes (UsdSemantics), colliders (UsdPhysics), lamps."""

import io
import math
from collections import Counter
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from eyas.engine.core.errors import ConfigError, MissingExtraError
from eyas.engine.core.files import refusals, write_atomic
from eyas.engine.core.scratch import scratch
from eyas.engine.sim.scenes import load_scene, load_textures
from eyas.engine.state.mesh import Material, Mesh, Surface
from eyas.engine.state.scene import ObjectClass, Scene
from eyas.engine.world.maps import MAPS
from eyas.maps.formats.gltf.file import PLAIN, light_factors
from eyas.maps.formats.gltf.world import CANDELAS, towards
from eyas.maps.formats.meshes import copies_of, parts_of, prism, prototypes_of, welded

if TYPE_CHECKING:
    from pxr import Sdf, Usd

_SHINING = {Surface.LAMP, Surface.SIGNAL}
_ROUGH = {Surface.WATER: 0.1, Surface.GLASS: 0.1, Surface.PAINT: 0.35}


class Materials:
    """Adds materials to a layer; call it within an `Sdf.ChangeBlock`.

    Attributes:
        textures: Names of the textures that they show.

    Args:
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


ENDINGS = (".usdc", ".usda", ".usd")  # Binary, text, either

_RADIUS = 0.1  # Radius of the sphere that shines in a street lamp [m]

_TOUCHED = {ObjectClass.GROUND, ObjectClass.ROAD, ObjectClass.PAVEMENT}
"""What is solid by its triangles; all else that is solid has colliders of its own."""


def write_usd(name: str, seed: int, path: Path, detail: int) -> int:
    """Write a map as a stage, and its textures into a folder beside it; return its number of
    triangles.

    Raises:
        MissingExtraError: The extra `usd` is not installed.
        EyasError: The map cannot be built, or a file not written.
    """
    if path.suffix not in ENDINGS:
        allowed = " or ".join(ENDINGS)
        raise ConfigError(f"--out: {path.name!r} is not allowed: a name that ends in {allowed}")
    try:
        from pxr import Usd
    except ImportError as error:
        raise MissingExtraError("the format 'usd'", "usd") from error
    scene, textures = load_scene(name, seed), load_textures()
    made = _Stage(Usd.Stage.CreateInMemory(), scene, f"{path.stem}-textures", detail)
    made.fill(MAPS.get(name).attribution())
    folder = path.with_name(f"{path.stem}-textures")
    with refusals(folder):
        folder.mkdir(parents=True, exist_ok=True)
    for used in sorted(made.textures):
        write_atomic(folder / f"{used}.png", _png(textures[used]))
    with scratch() as place:
        made.stage.GetRootLayer().Export(str(place / f"map{path.suffix}"))
        write_atomic(path, (place / f"map{path.suffix}").read_bytes())
    return made.triangles


def _png(pixels: NDArray[np.uint8]) -> bytes:
    png = io.BytesIO()
    Image.fromarray(np.ascontiguousarray(pixels)).save(png, format="PNG")
    return png.getvalue()


_FEW = 0.1  # Share of the faces of a smooth solid whose normals may point away from their front


class _Stage:
    """A stage under construction.

    Args:
        folder: Name of the folder of its textures.
    """

    def __init__(self, stage: "Usd.Stage", scene: Scene, folder: str, detail: int) -> None:
        self.stage, self.triangles = stage, 0
        self._shown = Materials(stage.GetRootLayer(), folder)
        self._scene, self._detail = scene, detail
        self._root = f"/{_valid(scene.name)}"
        self._materials: dict[Material, str] = {}
        self._used: Counter[str] = Counter()

    @property
    def textures(self) -> set[str]:
        """Names of the textures that its materials show."""
        return self._shown.textures

    def fill(self, notice: str) -> None:
        """Add everything."""
        from pxr import Kind, Usd, UsdGeom, UsdPhysics

        UsdGeom.SetStageUpAxis(self.stage, UsdGeom.Tokens.z)
        UsdGeom.SetStageMetersPerUnit(self.stage, 1.0)
        UsdPhysics.SetStageKilogramsPerUnit(self.stage, 1.0)
        root = UsdGeom.Xform.Define(self.stage, self._root).GetPrim()
        self.stage.SetDefaultPrim(root)
        Usd.ModelAPI(root).SetKind(Kind.Tokens.component)
        self.stage.GetRootLayer().documentation = "\n".join(["Made by Eyas.", notice]).strip()
        UsdPhysics.Scene.Define(self.stage, f"{self._root}/physics")
        self._add_materials()
        self._add_parts()
        self._add_lamps()
        self._add_colliders()
        self._add_copies()  # last, since each edit of a stage with many instances takes long

    def _place(self, group: str, name: str) -> str:
        """Return a path of its own in a group, which is made when it is first used."""
        from pxr import UsdGeom

        above = f"{self._root}/{_valid(group)}"
        if not self._used[above]:
            UsdGeom.Xform.Define(self.stage, above)
        self._used[above] += 1
        wanted = f"{above}/{_valid(name)}"
        self._used[wanted] += 1
        return wanted if self._used[wanted] == 1 else f"{wanted}_{self._used[wanted]}"

    def _label(self, prim: "Usd.Prim", kind: ObjectClass) -> None:
        from pxr import UsdSemantics

        labels = UsdSemantics.LabelsAPI.Apply(prim, "class")
        labels.CreateLabelsAttr([kind.name.lower()])

    def _add_parts(self) -> None:
        from pxr import UsdPhysics

        for part in parts_of(self._scene):
            kind = part.object_class
            place = self._place(kind.name.lower(), part.name)
            prim, triangles = self._mesh(place, part.mesh)
            self._label(prim, kind)
            if kind in _TOUCHED:
                UsdPhysics.CollisionAPI.Apply(prim)
                solid = UsdPhysics.MeshCollisionAPI.Apply(prim)
                solid.CreateApproximationAttr(UsdPhysics.Tokens.none)
            self.triangles += triangles

    def _add_copies(self) -> None:
        from pxr import Sdf, UsdGeom

        prototypes = prototypes_of(self._scene.fixtures, self._detail)
        above = f"{self._root}/prototypes"
        self.stage.CreateClassPrim(above)
        drawn: dict[int, tuple[str, int]] = {}
        for copies in copies_of(self._scene):
            shape, group = prototypes[copies.prototype], copies.object_class.name.lower()
            if not len(shape.triangles):
                continue
            if copies.prototype not in drawn:
                path = f"{above}/{_valid(copies.name)}_{copies.prototype}"
                UsdGeom.Xform.Define(self.stage, path)
                drawn[copies.prototype] = path, self._mesh(f"{path}/shape", shape)[1]
            path, triangles = drawn[copies.prototype]
            places = [
                self._place(group, f"{copies.name}_{number}") for number in range(len(copies.pose))
            ]
            # Object by object through the stage, thousands of copies would take a minute.
            with Sdf.ChangeBlock():
                for place, pose in zip(places, copies.pose, strict=True):
                    self._copy(place, path, pose, group)
            self.triangles += triangles * len(copies.pose)

    def _copy(self, path: str, prototype: str, pose: NDArray[np.float32], kind: str) -> None:
        """Add an instance of a prototype, with the label of its class."""
        from pxr import Gf, Sdf, Vt

        spec = Sdf.CreatePrimInLayer(self.stage.GetRootLayer(), path)
        spec.specifier, spec.typeName = Sdf.SpecifierDef, "Xform"
        spec.referenceList.prependedItems = [Sdf.Reference(primPath=prototype)]
        spec.instanceable = True
        whole = np.eye(4)
        whole[:, :3] = pose.T  # row vectors
        types = Sdf.ValueTypeNames
        uniform = Sdf.VariabilityUniform
        moved = Sdf.AttributeSpec(spec, "xformOp:transform", types.Matrix4d)
        moved.default = Gf.Matrix4d(whole.tolist())
        order = Sdf.AttributeSpec(spec, "xformOpOrder", types.TokenArray, uniform)
        order.default = Vt.TokenArray(["xformOp:transform"])
        applied = Sdf.TokenListOp.Create(prependedItems=["SemanticsLabelsAPI:class"])
        spec.SetInfo("apiSchemas", applied)
        label = Sdf.AttributeSpec(spec, "semantics:labels:class", types.TokenArray)
        label.default = Vt.TokenArray([kind])

    def _mesh(self, path: str, mesh: Mesh) -> tuple["Usd.Prim", int]:
        """Add a mesh, with subsets of its faces by material; return it and its triangle count."""
        from pxr import Sdf, UsdGeom, UsdShade, Vt

        mesh, thin = _fronting(mesh)
        made, shape = UsdGeom.Mesh.Define(self.stage, path), welded(mesh)
        self._shape(made, *shape.points)
        types = Sdf.ValueTypeNames
        for name, type_, told in (
            ("normals", types.Normal3fArray, shape.normals),
            ("st", types.TexCoord2fArray, shape.uvs),
        ):
            corners = UsdGeom.PrimvarsAPI(made).CreatePrimvar(
                name, type_, UsdGeom.Tokens.faceVarying
            )
            array = Vt.Vec3fArray if name == "normals" else Vt.Vec2fArray
            corners.Set(array.FromNumpy(np.ascontiguousarray(told.values, np.float32)))
            corners.SetIndices(Vt.IntArray.FromNumpy(told.corners.ravel().astype(np.int32)))
        used = np.unique(shape.materials).tolist()
        if thin or any(mesh.palette[index].surface is Surface.FOLIAGE for index in used):
            made.CreateDoubleSidedAttr(defaultValue=True)
        for index in used:
            place = self._materials[mesh.palette[index]]
            material = UsdShade.Material.Get(self.stage, place)
            prim = made.GetPrim()
            if len(used) > 1:
                faces = np.flatnonzero(shape.materials == index).astype(np.int32)
                subset = UsdGeom.Subset.CreateGeomSubset(
                    made, f"material_{index}", UsdGeom.Tokens.face,
                    Vt.IntArray.FromNumpy(faces), UsdShade.Tokens.materialBind,
                    UsdGeom.Tokens.partition,
                )  # fmt: skip
                prim = subset.GetPrim()
            UsdShade.MaterialBindingAPI.Apply(prim).Bind(material)
        if len(used) > 1:
            UsdShade.MaterialBindingAPI.Apply(made.GetPrim())
        return made.GetPrim(), len(shape.materials)

    def _shape(self, made: Any, points: NDArray[Any], triangles: NDArray[Any]) -> None:  # noqa: ANN401
        from pxr import UsdGeom, Vt

        points = np.ascontiguousarray(points, np.float32)
        made.CreatePointsAttr(Vt.Vec3fArray.FromNumpy(points))
        made.CreateFaceVertexCountsAttr(Vt.IntArray(len(triangles), 3))
        corners = np.ascontiguousarray(triangles.ravel(), np.int32)
        made.CreateFaceVertexIndicesAttr(Vt.IntArray.FromNumpy(corners))
        made.CreateSubdivisionSchemeAttr(UsdGeom.Tokens.none)
        ends = np.stack([points.min(axis=0), points.max(axis=0)])
        made.CreateExtentAttr(Vt.Vec3fArray.FromNumpy(ends))

    def _facet(self, made: Any) -> None:  # noqa: ANN401  # of pxr
        """Give a mesh a normal for each face."""
        from pxr import UsdGeom, Vt

        corners = np.array(made.GetPointsAttr().Get())[
            np.array(made.GetFaceVertexIndicesAttr().Get()).reshape(-1, 3)
        ]
        normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        normals /= np.maximum(np.sqrt(np.square(normals).sum(axis=1, keepdims=True)), 1e-12)
        made.CreateNormalsAttr(Vt.Vec3fArray.FromNumpy(normals.astype(np.float32)))
        made.SetNormalsInterpolation(UsdGeom.Tokens.uniform)

    def _add_materials(self) -> None:
        """Add the materials of all meshes."""
        from pxr import Sdf, UsdGeom

        group = f"{self._root}/materials"
        UsdGeom.Scope.Define(self.stage, group)
        prototypes = prototypes_of(self._scene.fixtures, self._detail)
        meshes = [part.mesh for part in parts_of(self._scene)] + prototypes
        with Sdf.ChangeBlock():  # through the stage, thousands of them would take long
            for mesh in meshes:
                for index in np.unique(mesh.materials).tolist():
                    material = mesh.palette[index]
                    if material not in self._materials:
                        name = f"{_valid(material.texture)}_{len(self._materials)}"
                        self._materials[material] = f"{group}/{name}"
                        self._shown.add(f"{group}/{name}", material)

    def _add_lamps(self) -> None:
        from pxr import Gf, UsdGeom, UsdLux

        lamps = self._scene.lamps
        for number, (place, axis) in enumerate(zip(lamps.position, lamps.axis, strict=True)):
            lamp = UsdLux.SphereLight.Define(self.stage, self._place("lamps", f"lamp_{number}"))
            lamp.CreateRadiusAttr(_RADIUS)
            lamp.CreateIntensityAttr(CANDELAS / (math.pi * _RADIUS * _RADIUS))  # nits
            lamp.CreateColorAttr(Gf.Vec3f(1.0, 0.87, 0.7))
            lamp.CreateExtentAttr([Gf.Vec3f(-_RADIUS), Gf.Vec3f(_RADIUS)])
            cone = UsdLux.ShapingAPI.Apply(lamp.GetPrim())
            cone.CreateShapingConeAngleAttr(math.degrees(lamps.cut_off))
            x, y, z, w = towards(axis).tolist()
            xform = UsdGeom.Xformable(lamp)
            xform.AddTranslateOp().Set(Gf.Vec3d(*place.astype(float).tolist()))
            xform.AddOrientOp().Set(Gf.Quatf(w, x, y, z))

    def _add_colliders(self) -> None:
        """Add what Eyas itself lets bodies touch and lidars see: prisms and cylinders."""
        from pxr import Gf, UsdGeom, UsdPhysics

        solids, kinds = self._scene.colliders, self._scene.object_class
        for number, (low, high) in enumerate(pairwise(solids.prism_first.tolist())):
            span = float(solids.prism_bottom[number]), float(solids.prism_top[number])
            made = UsdGeom.Mesh.Define(self.stage, self._place("colliders", f"prism_{number}"))
            self._shape(made, *prism(solids.prism_points[low:high], span))
            self._facet(made)
            UsdPhysics.MeshCollisionAPI.Apply(made.GetPrim()).CreateApproximationAttr(
                UsdPhysics.Tokens.none
            )
            self._solid(made, ObjectClass(int(kinds[solids.prism_object[number]])))
        for number, radius in enumerate(solids.cylinder_radius.tolist()):
            place = self._place("colliders", f"cylinder_{number}")
            made = UsdGeom.Cylinder.Define(self.stage, place)
            low, high = float(solids.cylinder_bottom[number]), float(solids.cylinder_top[number])
            made.CreateRadiusAttr(radius)
            made.CreateHeightAttr(high - low)
            made.CreateAxisAttr(UsdGeom.Tokens.z)
            half = Gf.Vec3f(radius, radius, 0.5 * (high - low))
            made.CreateExtentAttr([-half, half])
            x, y = solids.cylinder_centre[number].tolist()
            made.AddTranslateOp().Set(Gf.Vec3d(x, y, 0.5 * (low + high)))
            self._solid(made, ObjectClass(int(kinds[solids.cylinder_object[number]])))

    def _solid(self, made: Any, kind: ObjectClass) -> None:  # noqa: ANN401  # of pxr
        from pxr import UsdGeom, UsdPhysics

        made.CreatePurposeAttr(UsdGeom.Tokens.guide)
        UsdPhysics.CollisionAPI.Apply(made.GetPrim())
        self._label(made.GetPrim(), kind)


def _fronting(mesh: Mesh) -> tuple[Mesh, bool]:
    """Return a mesh whose faces front the side to which their normals point, and whether faces had
    to be turned: those of blades of grass, which are seen from both sides and lit like the tuft.
    """
    first, second, third = np.moveaxis(mesh.positions[mesh.triangles], 1, 0)
    front = np.cross(second - first, third - first)
    away = (front * mesh.normals[mesh.triangles[:, 0]]).sum(axis=1) < 0.0
    if not away.sum() > _FEW * len(away):
        return mesh, False
    triangles = np.where(away[:, None], mesh.triangles[:, [0, 2, 1]], mesh.triangles)
    return replace(mesh, triangles=triangles), True


def _valid(name: str) -> str:
    """Return a name that a prim can have."""
    from pxr import Tf

    valid: str = Tf.MakeValidIdentifier(name)
    return valid
