"""The camera as a device: shutter, shake, pixels that see changes."""
