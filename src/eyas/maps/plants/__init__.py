"""Trees, shrubs, hedges and gardens."""
