"""Maps and flights as binary glTF 2.0 (https://registry.khronos.org/glTF/specs/2.0), which most
programs for three-dimensional scenes open.
"""
