"""Those who ride."""
