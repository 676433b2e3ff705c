"""moderngl on Mesa's llvmpipe: the same scene with a shadow map, fog and mip-maps."""

import moderngl
import numpy as np
from city import Batch, City, projection, runs, seen

_VERTEX = """
#version 330
uniform mat4 clip; uniform mat4 sun_clip; uniform vec3 eye; uniform bool moved;
in vec3 position; in vec3 normal; in vec3 uv; in vec4 colour;
in vec4 row0; in vec4 row1; in vec4 row2; in vec3 paint;
out vec3 at; out vec3 up; out vec3 texture_at; out vec3 tint; out vec4 from_sun;
void main() {
  at = position; up = normal; tint = colour.rgb;
  if (moved) {
    vec4 p = vec4(position, 1);
    at = vec3(dot(row0, p), dot(row1, p), dot(row2, p));
    up = vec3(dot(row0.xyz, normal), dot(row1.xyz, normal), dot(row2.xyz, normal));
    tint *= mix(vec3(1), paint, colour.a);
  }
  texture_at = uv; from_sun = sun_clip * vec4(at, 1); gl_Position = clip * vec4(at, 1);
}"""
_FRAGMENT = """
#version 330
uniform sampler2DArray images; uniform sampler2DShadow shadows; uniform vec3 sun; uniform vec3 eye;
in vec3 at; in vec3 up; in vec3 texture_at; in vec3 tint; in vec4 from_sun;
out vec4 pixel;
void main() {
  vec4 texel = texture(images, texture_at);
  vec3 normal = normalize(up);
  vec3 place = from_sun.xyz * 0.5 + 0.5;
  float lit = max(dot(normal, sun), 0.0) * texture(shadows, vec3(place.xy, place.z - 0.001));
  vec3 light = vec3(0.24, 0.29, 0.37) * (0.5 + 0.5 * normal.z) + vec3(1.02, 0.96, 0.84) * lit;
  vec3 colour = pow(texel.rgb * tint, vec3(2.2)) * light;
  colour = mix(vec3(0.4, 0.46, 0.55), colour, exp(-distance(at, eye) / 4000.0));
  pixel = vec4(pow(colour, vec3(1.0 / 2.2)), 1);
}"""
_SHADOW = """
#version 330
uniform mat4 clip; in vec3 position;
void main() { gl_Position = clip * vec4(position, 1); }"""


class Peer:
    """Draws all views into one picture, a tile each."""

    def __init__(self, city: City, side: int) -> None:
        self._city, self._side = city, side
        self._gl = moderngl.create_context(standalone=True, backend="egl", require=330)
        self._gl.enable(moderngl.DEPTH_TEST | moderngl.CULL_FACE)
        self.name = f"moderngl on {self._gl.info['GL_RENDERER']}"
        layers, height, width, _ = city.textures.shape
        images = self._gl.texture_array(
            (width, height, layers), 4, city.textures[:, ::-1].tobytes()
        )
        images.build_mipmaps()
        images.filter = (moderngl.LINEAR_MIPMAP_LINEAR, moderngl.LINEAR)
        images.use(0)
        self._program = self._gl.program(_VERTEX, _FRAGMENT)
        self._static = self._vertices(city.static, None)
        self._parts = []
        for batch, poses, paint in zip(city.parts, city.slots, city.slot_colours, strict=True):
            data = np.concatenate([poses.reshape(-1, 12), paint], axis=1).astype(np.float32)
            if len(data):
                self._parts.append((self._vertices(batch, data), len(data)))
        self._program["sun"].value = tuple(city.sun)
        self._program["images"].value, self._program["shadows"].value = 0, 1
        self._bake()
        self._views(len(city.views.position))

    def _vertices(self, batch: Batch, instances: np.ndarray | None) -> moderngl.VertexArray:
        table = np.concatenate(
            [
                batch.positions,
                batch.normals,
                batch.uvs,
                batch.layers[:, None],
                batch.colours,
                batch.painted[:, None],
            ],
            axis=1,
        ).astype(np.float32)
        names = ["position", "normal", "uv", "colour"]
        content = [(self._gl.buffer(table.tobytes()), "3f 3f 3f 4f", *names)]
        if instances is None:
            instances = np.zeros((1, 15), np.float32)
        rows = ["row0", "row1", "row2", "paint"]
        content.append((self._gl.buffer(instances.tobytes()), "4f 4f 4f 3f/i", *rows))
        return self._gl.vertex_array(self._program, content)

    def _bake(self) -> None:
        """Draw the shadow map of the static scene, once."""
        sun = self._city.sun
        right = np.cross([0.0, 0.0, 1.0], sun)
        right /= np.linalg.norm(right)
        clip = np.eye(4)
        clip[:3, :3] = np.stack([right / 520, np.cross(sun, right) / 520, -sun / 700])
        depth = self._gl.depth_texture((4096, 4096))
        depth.compare_func = "<="
        target = self._gl.framebuffer(depth_attachment=depth)
        target.use()
        target.clear()
        program = self._gl.program(_SHADOW, "#version 330\nvoid main() {}")
        program["clip"].write(clip.T.astype(np.float32).tobytes())
        buffer = self._gl.buffer(self._city.static.positions.astype(np.float32).tobytes())
        self._gl.vertex_array(program, [(buffer, "3f", "position")]).render()
        depth.use(1)
        self._program["sun_clip"].write(clip.T.astype(np.float32).tobytes())

    def _views(self, count: int) -> None:
        self._across = int(np.ceil(np.sqrt(count)))
        size = (self._across * self._side, -(-count // self._across) * self._side)
        colour = self._gl.texture(size, 4)
        self._target = self._gl.framebuffer([colour], self._gl.depth_texture(size))
        self.rgb = np.empty((size[1], size[0], 4), np.uint8)
        self._clips = projection(self._city.views, self._side, self._side)

    def draw(self) -> None:
        """Draw all views and read them back into `rgb`."""
        self._target.use()
        self._target.viewport = (0, 0, self.rgb.shape[1], self.rgb.shape[0])
        self._target.clear(0.6, 0.7, 0.85, 1.0)
        first, program, side = self._city.static.first, self._program, self._side
        for k, clip in enumerate(self._clips):
            corner = (k % self._across * side, k // self._across * side)
            self._target.viewport = (*corner, side, side)
            program["clip"].write(clip.T.astype(np.float32).tobytes())
            program["eye"].value = tuple(self._city.views.position[k])
            program["moved"].value = False
            for a, b in runs(seen(self._city.static.boxes, clip)):
                self._static.render(vertices=int(first[b] - first[a]), first=int(first[a]))
            program["moved"].value = True
            for part, count in self._parts:
                part.render(instances=count)
        self._target.read_into(self.rgb, components=4)
