"""Configuration of the documentation's site: `make site`."""

# ruff: noqa: INP001, A001 - not a package; the names are Sphinx's

import tomllib
from pathlib import Path

from docutils import nodes
from pygments.lexers.special import TextLexer
from sphinx.application import Sphinx
from sphinx.transforms.post_transforms import SphinxPostTransform
from sphinx.util.docutils import SphinxDirective

project = "firmware-bridge"
copyright = "the firmware-bridge authors"
extensions = ["myst_parser", "sphinx.ext.autodoc"]
autodoc_default_options = {"members": True, "member-order": "bysource"}
autodoc_typehints = "description"
autodoc_class_signature = "separated"
python_use_unqualified_type_names = True
# What docstrings have in backticks.
default_role = "code"
html_theme = "furo"
html_title = "firmware-bridge"
html_show_sphinx = False
html_static_path = ["static"]
html_css_files = ["tables.css"]
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


class EntryPoints(SphinxDirective):
    """The groups of entry points of pyproject.toml that a package of others may add to, and their entries."""

    def run(self) -> list[nodes.Node]:
        """Return a list of the groups, with the objects that this project has in each."""
        file = ROOT / "pyproject.toml"
        self.env.note_dependency(str(file))
        project = tomllib.loads(file.read_text(encoding="utf-8"))["project"]
        groups = nodes.bullet_list()
        for group, entries in project["entry-points"].items():
            if group.startswith("firmware_bridge."):
                shown = nodes.paragraph("", "", nodes.literal("", group), nodes.Text(": "))
                for place, entry in enumerate(entries.items()):
                    shown += [nodes.Text(", " if place else ""), nodes.literal("", " = ".join(entry))]
                groups += nodes.list_item("", shown)
        return [groups]


def skipped(_app: Sphinx, _kind: str, _name: str, member: object, skip: bool, _options: object) -> bool:  # noqa: FBT001
    """Leave out names of the release before, which work with a warning."""
    words = (getattr(member, "__doc__", None) or "").partition("\n")[0]
    return skip or any(word in words for word in ("old name", "release before"))


def setup(app: Sphinx) -> dict[str, bool]:
    """Register what is not Sphinx's own."""
    app.add_post_transform(PathsOutside)
    app.connect("autodoc-skip-member", skipped)
    app.add_directive("entry-points", EntryPoints)
    # Its text is shown: the library that draws it would come from an address outside.
    app.add_lexer("mermaid", TextLexer)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
