"""The safety tests that a robot gets because it is installed: its file, its rows, its cases, its missions.

`pytest --robot NAME --pyargs emulators.testing.inherited`; without a name those of every installed robot.
"""
