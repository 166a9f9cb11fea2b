"""How the site looks, beside static/: a class for tables of pictures, and what Debian's theme needs to work from a folder.

Debian's furo is not bundled: its styles import normalize.css from /javascript, which only a server that Debian's packages
set up has, and its script imports another as a module, which no browser does from a file, nor from the plain <script> that
the theme itself writes. Both are put where they are wanted. And the compiler of Debian's styles lost the dark colours for
readers whose system is dark; they are those of the theme's own switch.
"""

import pathlib
import re
import shutil

from docutils import nodes
from sphinx.errors import ExtensionError
from sphinx.transforms import SphinxTransform

DEBIANS_STYLE = "@import url(/javascript/normalize.css/normalize.css);"
DEBIANS_FILE = pathlib.Path("/usr/share/nodejs/normalize.css/normalize.css")
DEBIANS_SCRIPT = 'import Gumshoe from "./gumshoe-patched.js";'


class PictureTables(SphinxTransform):
    """A table with a picture in each cell is a row of pictures, and a column of them on a phone."""

    default_priority = 400

    def apply(self, **kwargs):
        for table in self.document.findall(nodes.table):
            cells = list(table.findall(nodes.entry))
            if cells and all(next(cell.findall(nodes.image), None) is not None for cell in cells):
                table["classes"].append("pictures")


def mend_theme(app, exception):
    static = pathlib.Path(app.outdir) / "_static"
    style, script = static / "styles" / "furo.css", static / "scripts" / "furo.js"
    if exception or not style.is_file():
        return
    text = style.read_text(encoding="utf-8")
    if DEBIANS_STYLE in text:
        if not DEBIANS_FILE.is_file():
            raise ExtensionError(f"no {DEBIANS_FILE}, which Debian's theme furo imports: install node-normalize.css")
        text = text.replace(DEBIANS_STYLE, "@import url(normalize.css);")
        shutil.copy(DEBIANS_FILE, style.parent / "normalize.css")
    dark = re.search(r'body\[data-theme="dark"\] \{([^}]*)\}', text)
    if "prefers-color-scheme" not in text and dark:
        text += f'@media screen and (prefers-color-scheme: dark) {{ body:not([data-theme="light"]) {{{dark.group(1)}}} }}\n'
    style.write_text(text, encoding="utf-8")
    text = script.read_text(encoding="utf-8")
    if DEBIANS_SCRIPT in text:
        imported = (script.parent / "gumshoe-patched.js").read_text(encoding="utf-8")  # defines Gumshoe for the window
        script.write_text(imported + text.replace(DEBIANS_SCRIPT, ""), encoding="utf-8")


def setup(app):
    app.add_transform(PictureTables)
    app.connect("build-finished", mend_theme)
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": True}
