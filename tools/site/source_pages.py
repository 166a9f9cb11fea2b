"""A page for each file of the repository that a page links to: its text with line numbers, or what is in the folder."""

import html
import pathlib

from pygments import highlight
from pygments.formatters import HtmlFormatter
from pygments.lexers import TextLexer, get_lexer_for_filename
from pygments.util import ClassNotFound
from sphinx.environment import BuildEnvironment


def source_page(env, path):
    """The name of the page of a file or folder, which is made when the pages are written."""
    env.sources.setdefault(env.docname, set()).add(path)
    return f"source/{path}"


def lexer_of(path):
    try:
        return get_lexer_for_filename("x.cpp" if path.suffix in (".hpp", ".inl") else path.name)
    except ClassNotFound:
        return TextLexer()


def body_of(root, path):
    """The HTML of a file or a folder; a ValueError where it is neither text nor a folder."""
    place = root / path
    if place.is_dir():
        names = sorted(child.name + ("/" if child.is_dir() else "") for child in place.iterdir() if child.name[0] != ".")
        return "<ul>" + "".join(f"<li><code>{html.escape(name)}</code></li>" for name in names) + "</ul>"
    text = place.read_text(encoding="utf-8")
    return highlight(text, lexer_of(place), HtmlFormatter(linenos="inline", lineanchors="L", wrapcode=True))


def collect(app):
    root = pathlib.Path(app.srcdir)
    for path in sorted(set().union(*app.env.sources.values())):
        heading = f'<section id="source"><h1><code>{html.escape(path)}</code></h1>'
        yield f"source/{path}", {"title": path, "body": f"{heading}{body_of(root, path)}</section>"}, "page.html"


def begin(app):
    if not hasattr(app.env, "sources"):
        app.env.sources = {}


def forget(app, env, docname):
    env.sources.pop(docname, None)


def merge(app, env, docnames, other):
    env.sources.update({name: other.sources[name] for name in docnames if name in other.sources})


def setup(app):
    BuildEnvironment.source_page = source_page
    app.connect("builder-inited", begin)
    app.connect("env-purge-doc", forget)
    app.connect("env-merge-info", merge)
    app.connect("html-collect-pages", collect)
    return {"version": "1", "env_version": 1, "parallel_read_safe": True, "parallel_write_safe": True}
