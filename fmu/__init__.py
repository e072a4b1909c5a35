"""Plants as FMUs: equations to C, built on demand, loaded and stepped; and the plants of our own robots.

Public, for a plant of one's own: `plants` (what a plant is, and which there are), `export.model` and
`export.functions` (what equations are made of), `parts`, `build`, `plant` (a plant in step), `check`,
`interface` (names and units that drives ask for), `errors`.
"""
