"""The repository as the source of a site: which file is which page, and where a link leads.

The source folder of Sphinx is the root of the repository, so that links between docs/, the root and the sources are what
they are on a code host. A page's name leaves out docs/, and docs/README.md is the first page, index. Pages that other
extensions make are kept in a folder of the build (Pages.made).

Every link that is no address on the web is resolved here, by the path of the file that has it: to a page or to an anchor
of one. A link to another file of the repository becomes its name, and one to no file is a warning.
"""

import pathlib
import posixpath
import urllib.parse

from docutils import nodes
from sphinx import addnodes
from sphinx.project import Project
from sphinx.transforms import SphinxTransform
from sphinx.transforms.post_transforms import SphinxPostTransform
from sphinx.util import logging

LOGGER = logging.getLogger(__name__)
FIRST_PAGE = "docs/README.md"


class Pages(Project):
    """Names of pages for paths from the root of the repository, and back."""

    def __init__(self, srcdir, source_suffix, made):
        super().__init__(srcdir, source_suffix)
        self.made = made  # the folder of pages that are made for the site

    def discover(self, exclude_paths=(), include_paths=("**",)):
        found = super().discover(exclude_paths, include_paths)
        found |= {path.relative_to(self.made).with_suffix("").as_posix() for path in self.made.rglob("*.md")}
        self.docnames = found
        return found

    def path2doc(self, filename):
        path = pathlib.Path(self.srcdir, filename)
        if self.made in path.parents:
            path = pathlib.Path(self.srcdir, "docs", path.relative_to(self.made))
        name = super().path2doc(str(path))
        if name is None:
            return None
        if name + ".md" == FIRST_PAGE:
            return "index"
        return name[len("docs/"):] if name.startswith("docs/") else name

    def doc2path(self, docname, basedir=True):
        path = self.place(docname)
        made = self.made / f"{docname}.md"
        if basedir and made.is_file():
            return str(made)
        return str(pathlib.Path(self.srcdir, path)) if basedir else path

    def place(self, docname):
        """The path of a page from the root; that of a page which is made is where it would be in docs/."""
        if docname == "index":
            return FIRST_PAGE
        inside = f"docs/{docname}.md"
        if pathlib.Path(self.srcdir, inside).is_file() or not pathlib.Path(self.srcdir, f"{docname}.md").is_file():
            return inside
        return f"{docname}.md"


class Anchors(SphinxTransform):
    """A heading can be linked to by the name that a code host gives it."""

    default_priority = 200

    def apply(self, **kwargs):
        for section in self.document.findall(nodes.section):
            anchor = section.get("myst-anchor", "").rpartition("#")[2]
            if anchor and anchor not in section["ids"]:
                section["ids"].append(anchor)


class Links(SphinxTransform):
    """Gives each relative link its page; a file that is no page is named only."""

    default_priority = 300

    def apply(self, **kwargs):
        for kind in (addnodes.download_reference, addnodes.pending_xref):
            for node in list(self.document.findall(kind)):
                if node.get("reftype") == "myst":
                    self.resolve(node)

    def resolve(self, node):
        path, _, anchor = urllib.parse.unquote(node["reftarget"]).partition("#")
        page = self.env.docname
        here = self.env.project.place(page)
        target = posixpath.normpath(posixpath.join(posixpath.dirname(here), path) if not path.startswith("/") else path[1:])
        if path:
            page = "index" if target == "README.md" else self.env.path2doc(target)  # a code host shows README.md first
        if page not in self.env.found_docs:
            if not pathlib.Path(self.env.srcdir, target).exists():
                LOGGER.warning("the link '%s' leads nowhere", node["reftarget"], location=node)
            node.replace_self(node.children or nodes.literal("", posixpath.basename(target)))
            return
        link = addnodes.pending_xref(reftype="repository", refdomain=None, page=page, anchor=anchor, refdoc=self.env.docname,
                                     refwarn=True)
        link.source, link.line = node.source, node.line
        children = [child for node_inside in node.children for child in node_inside.children]
        link += nodes.inline("", "", *children) if children else nodes.literal("", posixpath.basename(target))
        node.replace_self(link)


class Arrivals(SphinxPostTransform):
    """Writes the addresses of the links above, once all pages are known."""

    default_priority = 5

    def run(self, **kwargs):
        for node in list(self.document.findall(addnodes.pending_xref)):
            if node.get("reftype") != "repository":
                continue
            anchor = node["anchor"]
            if anchor and anchor not in self.env.page_anchors.get(node["page"], ()):
                LOGGER.warning("there is no heading '#%s' in %s", anchor, node["page"], location=node)
            address = self.app.builder.get_relative_uri(node["refdoc"], node["page"])
            reference = nodes.reference("", "", *node.children, internal=True, refuri=address + ("#" + anchor if anchor else ""))
            node.replace_self(reference)


def remember_anchors(app, doctree):
    anchors = {name for node in doctree.findall(nodes.Element) for name in node.get("ids", ())}
    app.env.page_anchors[app.env.docname] = anchors


def forget(app, env, docname):
    env.page_anchors.pop(docname, None)


def merge(app, env, docnames, other):
    env.page_anchors.update({name: other.page_anchors[name] for name in docnames if name in other.page_anchors})


def begin(app):
    """Before the pages are looked for: the paths of this repository take the place of Sphinx's."""
    made = pathlib.Path(app.doctreedir).parent / "made"
    made.mkdir(parents=True, exist_ok=True)
    app.project = app.env.project = Pages(app.srcdir, app.config.source_suffix, made)
    if not hasattr(app.env, "page_anchors"):
        app.env.page_anchors = {}


def setup(app):
    app.connect("builder-inited", begin, priority=100)
    app.add_transform(Anchors)
    app.add_transform(Links)
    app.add_post_transform(Arrivals)
    app.connect("doctree-read", remember_anchors)
    app.connect("env-purge-doc", forget)
    app.connect("env-merge-info", merge)
    return {"version": "1", "env_version": 1, "parallel_read_safe": True, "parallel_write_safe": True}
