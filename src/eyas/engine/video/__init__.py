"""Recording videos with labels."""
