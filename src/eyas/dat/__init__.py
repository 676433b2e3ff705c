"""The DAT benchmark: its protocol, its `env_config.json`, its PROTO files, its Webots project.

May import: `eyas.engine`, `eyas.lanes`, `eyas.maps`.
Begin with `README.md`, then `wire/server.py` and `settings/adapter.py`.
"""
