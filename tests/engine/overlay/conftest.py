from ..render.conftest import drawn, images, renderer_of

__all__ = ["drawn", "images", "renderer_of"]
