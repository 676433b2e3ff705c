"""Networks and traffic of SUMO that others have made."""
