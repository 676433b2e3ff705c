"""Scene, parts and light packed into the arrays that the kernels read."""
