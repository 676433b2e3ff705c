"""What a real camera makes of light: lens, shutter, imager, dirt, and the link of its pictures."""
