"""Motion off the traffic: pedestrians and robots that walk and drive by themselves."""
