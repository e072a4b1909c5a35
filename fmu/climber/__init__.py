"""The climbing robot: equations, parameters and reference trajectory of two magnetic wheels on a tank."""
