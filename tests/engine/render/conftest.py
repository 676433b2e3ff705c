from ...kit.renderers import city, drawn, images, renderer_of

__all__ = ["city", "drawn", "images", "renderer_of"]
