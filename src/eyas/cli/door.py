"""The door of this house, see `eyas.engine.core.doors`."""

from eyas.engine.core.doors import House

HOUSE = House(
    results=False,
    brings={
        "eyas.commands": {
            "video": "eyas.cli.runs:video",
            "run": "eyas.cli.runs:run",
            "serve": "eyas.cli.runs:serve",
            "targets": "eyas.cli.targets.commands:app",
            "bring": "eyas.cli.tools:bring",
            "open": "eyas.cli.tools:open_run",
            "config": "eyas.cli.tools:config_app",
            "cache": "eyas.cli.tools:cache_app",
            "bench": "eyas.cli.tools:bench",
            "verify": "eyas.cli.tools:verify",
            "doctor": "eyas.cli.tools:doctor",
            "about": "eyas.cli.tools:about",
            "completion": "eyas.cli.completion:completion",
        },
        "eyas.command_line": {"eyas": "eyas.cli.main:main"},
    },
)
