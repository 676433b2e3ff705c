"""What draws the data of the package: see `README.md`. It imports Eyas; Eyas never imports it."""
