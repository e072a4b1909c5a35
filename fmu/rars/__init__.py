"""RARS: equations, parameters and reference trajectory of the four-drive platform."""
