"""`eyas verify`: whether this machine computes the bytes that the manifest promises."""
