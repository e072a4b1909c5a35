"""Configuration of the documentation's site: `make site`."""

# ruff: noqa: INP001, A001 - not a package; the names are Sphinx's

from pathlib import Path

from docutils import nodes
from pygments.lexers.special import TextLexer
from sphinx.application import Sphinx
from sphinx.transforms.post_transforms import SphinxPostTransform

project = "firmware-bridge"
copyright = "the firmware-bridge authors"
extensions = ["myst_parser"]
html_theme = "furo"
html_title = "firmware-bridge"
html_show_sphinx = False
myst_heading_anchors = 4
myst_enable_extensions = ["colon_fence"]
exclude_patterns = ["_build"]
ROOT = Path(__file__).parents[2]


class PathsOutside(SphinxPostTransform):
    """Links to files of the repository that are no pages: the site shows their paths."""

    # Before MyST's own, which would report a missing page.
    default_priority = 5

    def run(self, **_: object) -> None:
        """Replace each link that leads out of docs/ by its text and the path; a missing file stays a link."""
        folder = (ROOT / "docs" / self.env.docname).parent
        for link in list(self.document.findall(lambda node: "reftarget" in getattr(node, "attributes", {}))):
            named = (folder / link["reftarget"].partition("#")[0]).resolve()
            # MyST has taken the suffix of a page off.
            target = next((one for one in (named, named.with_suffix(".md")) if one.exists()), None)
            if target is not None and ROOT / "docs" not in target.parents:
                shown = nodes.inline("", "", *link.children)
                shown += nodes.Text(" (")
                shown += nodes.literal("", str(target.relative_to(ROOT)))
                shown += nodes.Text(")")
                link.replace_self(shown)


def setup(app: Sphinx) -> dict[str, bool]:
    """Register what is not Sphinx's own."""
    app.add_post_transform(PathsOutside)
    # Its text is shown: the library that draws it would come from an address outside.
    app.add_lexer("mermaid", TextLexer)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
