"""Sky, clouds, horizon and falling snow."""
