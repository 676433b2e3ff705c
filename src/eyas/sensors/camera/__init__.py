"""What a real camera does to the light that reaches it, from its lens to the link's far end.

Each part has its settings beside its code, is off by default, and then does not exist.
"""
