"""Identity of code: what the build is, and of which definitions a function is made."""
