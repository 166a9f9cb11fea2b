"""The navigation of the site is what docs/README.md lists: each of its headings is a part, each link to a page an entry.

So there is one list of the pages, and a page that is not in it is an error of the build ("isn't included in any toctree").
"""

import re

HEADING = re.compile(r"^## +(.+?) *$", re.MULTILINE)
LINK = re.compile(r"\[([^\]]+)\]\((?!\w+:)([^)#\s]+\.md)\)")


def parts_of(text):
    """(heading, [(text of the link, path)]) for the headings that have links to pages, each page once."""
    pieces, seen = HEADING.split(text), set()
    for heading, body in zip(pieces[1::2], pieces[2::2]):
        entries = []
        for name, path in LINK.findall(body):
            if path not in seen:
                seen.add(path)
                entries.append((" ".join(name.split()), path))
        if entries:
            yield heading, entries


def toctree(caption, entries):
    lines = ["", "```{toctree}", ":hidden:"]
    lines += [f":caption: {caption}"] if caption else []
    return "\n".join(lines + [""] + [f"{name} </{page}>" for name, page in entries] + ["```", ""])


def add_navigation(app, docname, source):
    if docname != app.config.root_doc:
        return
    for heading, entries in list(parts_of(source[0])):
        pages = []
        for name, path in entries:
            page = app.env.path2doc(app.env.relfn2path(path)[0])
            pages.append((name[0].upper() + name[1:], page))
        source[0] += toctree(heading, pages)


def setup(app):
    app.connect("source-read", add_navigation)
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": True}
