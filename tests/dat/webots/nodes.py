"""The nodes that the project uses, after Webots' published reference (R2023b).

Transcribed from https://github.com/cyberbotics/webots/tree/released/resources/nodes, the files
*.wrl by which Webots itself knows its nodes, and https://cyberbotics.com/doc/reference: fields of
each node with their types, and after a colon what a field of nodes may hold.
"""

_POSE = "translation:SFVec3f rotation:SFRotation children:MFNode:*"
_SOLID = (
    f"{_POSE} name:SFString model:SFString description:SFString contactMaterial:SFString "
    "immersionProperties:MFNode boundingObject:SFNode:bounding physics:SFNode:Physics "
    "locked:SFBool radarCrossSection:SFFloat recognitionColors:MFColor translationStep:SFFloat "
    "rotationStep:SFFloat"
)
_LIGHT = (
    "ambientIntensity:SFFloat color:SFColor direction:SFVec3f intensity:SFFloat on:SFBool "
    "castShadows:SFBool"
)

_TABLE = {
    "WorldInfo": (
        "info:MFString title:SFString window:SFString gravity:SFFloat CFM:SFFloat ERP:SFFloat "
        "physics:SFString basicTimeStep:SFFloat FPS:SFFloat optimalThreadCount:SFInt32 "
        "defaultDamping:SFNode coordinateSystem:SFString gpsCoordinateSystem:SFString "
        "gpsReference:SFVec3f lineScale:SFFloat randomSeed:SFInt32 contactProperties:MFNode"
    ),
    "Viewpoint": (
        "fieldOfView:SFFloat orientation:SFRotation position:SFVec3f description:SFString "
        "near:SFFloat far:SFFloat exposure:SFFloat follow:SFString followType:SFString "
        "followSmoothness:SFFloat lensFlare:SFNode ambientOcclusionRadius:SFFloat "
        "bloomThreshold:SFFloat"
    ),
    "Background": "skyColor:MFColor luminosity:SFFloat",
    "DirectionalLight": f"{_LIGHT} castLensFlares:SFBool",
    "SpotLight": (
        f"{_LIGHT} attenuation:SFVec3f beamWidth:SFFloat cutOffAngle:SFFloat location:SFVec3f "
        "radius:SFFloat"
    ),
    "Fog": "color:SFColor fogType:SFString visibilityRange:SFFloat",
    "Group": "children:MFNode:*",
    "Pose": f"{_POSE} translationStep:SFFloat rotationStep:SFFloat",
    "Transform": f"{_POSE} scale:SFVec3f translationStep:SFFloat rotationStep:SFFloat",
    "Solid": _SOLID,
    "Robot": (
        f"{_SOLID} controller:SFString controllerArgs:MFString customData:SFString "
        "supervisor:SFBool synchronization:SFBool battery:MFFloat cpuConsumption:SFFloat "
        "selfCollision:SFBool window:SFString remoteControl:SFString"
    ),
    "Camera": (
        f"{_SOLID} fieldOfView:SFFloat width:SFInt32 height:SFInt32 near:SFFloat far:SFFloat "
        "exposure:SFFloat antiAliasing:SFBool noise:SFFloat"
    ),
    "Lidar": (
        f"{_SOLID} tiltAngle:SFFloat horizontalResolution:SFInt32 fieldOfView:SFFloat "
        "verticalFieldOfView:SFFloat numberOfLayers:SFInt32 near:SFFloat minRange:SFFloat "
        "maxRange:SFFloat type:SFString projection:SFString noise:SFFloat resolution:SFFloat"
    ),
    "GPS": f"{_SOLID} type:SFString accuracy:SFFloat resolution:SFFloat",
    "InertialUnit": f"{_SOLID} noise:SFFloat resolution:SFFloat",
    "Gyro": f"{_SOLID} resolution:SFFloat",
    "Accelerometer": f"{_SOLID} resolution:SFFloat",
    "HingeJoint": (
        "jointParameters:SFNode:HingeJointParameters device:MFNode:RotationalMotor,PositionSensor "
        "endPoint:SFNode:Solid"
    ),
    "HingeJointParameters": (
        "position:SFFloat axis:SFVec3f anchor:SFVec3f minStop:SFFloat maxStop:SFFloat "
        "dampingConstant:SFFloat"
    ),
    "RotationalMotor": (
        "name:SFString acceleration:SFFloat maxVelocity:SFFloat minPosition:SFFloat "
        "maxPosition:SFFloat maxTorque:SFFloat"
    ),
    "PositionSensor": "name:SFString noise:SFFloat resolution:SFFloat",
    "Shape": "appearance:SFNode:PBRAppearance geometry:SFNode:geometry castShadows:SFBool",
    "PBRAppearance": (
        "baseColor:SFColor baseColorMap:SFNode:ImageTexture transparency:SFFloat roughness:SFFloat "
        "metalness:SFFloat emissiveColor:SFColor emissiveIntensity:SFFloat name:SFString"
    ),
    "ImageTexture": "url:MFString repeatS:SFBool repeatT:SFBool filtering:SFInt32",
    "IndexedFaceSet": (
        "coord:SFNode:Coordinate normal:SFNode:Normal texCoord:SFNode:TextureCoordinate ccw:SFBool "
        "convex:SFBool normalPerVertex:SFBool coordIndex:MFInt32 normalIndex:MFInt32 "
        "texCoordIndex:MFInt32 creaseAngle:SFFloat"
    ),
    "Coordinate": "point:MFVec3f",
    "Normal": "vector:MFVec3f",
    "TextureCoordinate": "point:MFVec2f",
    "ElevationGrid": (
        "height:MFFloat xDimension:SFInt32 xSpacing:SFFloat yDimension:SFInt32 ySpacing:SFFloat "
        "thickness:SFFloat"
    ),
    "Box": "size:SFVec3f",
    "Cylinder": (
        "bottom:SFBool height:SFFloat radius:SFFloat side:SFBool top:SFBool subdivision:SFInt32"
    ),
}

GEOMETRIES = {"IndexedFaceSet", "ElevationGrid", "Box", "Cylinder"}
BOUNDING = {*GEOMETRIES, "Shape", "Pose", "Group"}
"""What a `boundingObject` may consist of (reference/solid.md)."""

SOLIDS = {"Solid", "Robot", "Camera", "Lidar", "GPS", "InertialUnit", "Gyro", "Accelerometer"}
"""Solid and what is derived from it: never below a Transform (reference/solid.md), and its like
never shown again by USE (reference/def-and-use.md)."""

CHILDREN = SOLIDS | {
    *("Group", "Pose", "Transform", "Shape", "HingeJoint", "DirectionalLight", "SpotLight")
}
"""What `children` may hold."""

FIELDS = {
    kind: {part.split(":")[0]: tuple(part.split(":")[1:]) for part in text.split()}
    for kind, text in _TABLE.items()
}

CHOICES = {
    ("Fog", "fogType"): {"LINEAR", "EXPONENTIAL", "EXPONENTIAL2"},
    ("WorldInfo", "coordinateSystem"): {"ENU", "NUE"},
}
RANGES = {
    ("SpotLight", "cutOffAngle"): (0.0, 1.5708), ("SpotLight", "beamWidth"): (0.0, 1.5708),
    ("PBRAppearance", "roughness"): (0.0, 1.0), ("PBRAppearance", "metalness"): (0.0, 1.0),
    ("Fog", "visibilityRange"): (0.0, 1e9), ("Camera", "fieldOfView"): (0.0, 3.1416),
    ("Background", "luminosity"): (0.0, 1e9), ("DirectionalLight", "intensity"): (0.0, 1e9),
}  # fmt: skip
