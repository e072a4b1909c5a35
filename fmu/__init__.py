"""Plants as FMUs: equations to C, built on demand, loaded and stepped; and the plants of our own robots.

Public, for a plant of one's own: `plants` (what a plant is, and which there are), `export.model` and
`export.functions` (what equations are made of), `parts`, `build`, `plant` (a plant in step), `check`,
`interface` (names and units that drives ask for), `errors`.
"""

from pkgutil import extend_path

# Others publish under this name as well, in folders of their own: fmu-tools, fmu-config.
__path__ = extend_path(__path__, __name__)
