"""The simulation: joins the other packages, and owns the clock and the step."""
