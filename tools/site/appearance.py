"""How the site looks, beside static/site.css: a class for tables of pictures, and normalize.css beside the theme's styles.

Debian's furo imports normalize.css from /javascript, which only a server that Debian's packages set up has.
"""

import pathlib
import shutil

from docutils import nodes
from sphinx.errors import ExtensionError
from sphinx.transforms import SphinxTransform

DEBIANS_IMPORT = "@import url(/javascript/normalize.css/normalize.css);"
DEBIANS_FILE = pathlib.Path("/usr/share/nodejs/normalize.css/normalize.css")


class PictureTables(SphinxTransform):
    """A table with a picture in each cell is a row of pictures, and a column of them on a phone."""

    default_priority = 400

    def apply(self, **kwargs):
        for table in self.document.findall(nodes.table):
            cells = list(table.findall(nodes.entry))
            if cells and all(next(cell.findall(nodes.image), None) is not None for cell in cells):
                table["classes"].append("pictures")


def bring_normalize(app, exception):
    style = pathlib.Path(app.outdir) / "_static" / "styles" / "furo.css"
    if exception or not style.is_file():
        return
    text = style.read_text(encoding="utf-8")
    if DEBIANS_IMPORT in text:
        if not DEBIANS_FILE.is_file():
            raise ExtensionError(f"no {DEBIANS_FILE}, which Debian's theme furo imports: install node-normalize.css")
        style.write_text(text.replace(DEBIANS_IMPORT, "@import url(normalize.css);"), encoding="utf-8")
        shutil.copy(DEBIANS_FILE, style.parent / "normalize.css")


def setup(app):
    app.add_transform(PictureTables)
    app.connect("build-finished", bring_normalize)
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": True}
