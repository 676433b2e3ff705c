"""The simulation: joins the rooms, owns the clock and the step."""
