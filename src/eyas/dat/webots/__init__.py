"""A map as a project of Webots R2023b, laid out as the original's: worlds, protos, controllers."""
