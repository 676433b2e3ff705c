"""The door of this house, see `eyas.engine.core.doors`."""

from eyas.engine.core.doors import House

HOUSE = House(
    results=True,
    brings={
        "eyas.settings": {"train": "eyas.learning.config:TrainConfig"},
        "eyas.presets": {
            "eyas": "eyas.learning:presets/eyas.json",
            "eyas-words": "eyas.learning:presets/eyas-words.json",
            "fast": "eyas.learning:presets/fast.json",
            "gc-vat": "eyas.learning:presets/gc-vat.json",
            "pursuit": "eyas.learning:presets/pursuit.json",
            "paper": "eyas.learning:presets/paper.json",
        },
        "eyas.commands": {"train": "eyas.learning.commands:train"},
    },
)
