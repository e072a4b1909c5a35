"""Plants: a robot's dynamics as equations, exported to FMUs, and the one place that loads them."""
