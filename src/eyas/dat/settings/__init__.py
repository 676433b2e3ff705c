"""The adapter between our settings and the original's `env_config.json`."""
