"""The safety tests of every installed robot: its file, its interlocks, its cases, its missions.

`pytest --robot NAME --pyargs emulators.testing.inherited`; without a name those of every installed robot.
"""
