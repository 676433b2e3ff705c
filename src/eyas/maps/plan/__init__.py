"""One plan for every map: its records, its file, and the builder that makes a scene of it."""
