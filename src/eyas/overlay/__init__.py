"""Overlays on finished pictures: the view of a camera, the rewarded area, the target."""
