from ...kit.frames import episode, frame, run

__all__ = ["episode", "frame", "run"]
