#!/usr/bin/env python3
"""Checks a built site without a network: every link and picture in it, and that every page can be reached.

  check_site.py SITE [ROOT]    ROOT: the repository whose docs/ the site was made from [this one]

A link inside the site has to lead to a file of the site and to an anchor of it; nothing may be loaded from outside; every
page of ROOT/docs has to be in the site and in the navigation of the first page. Links to the web are listed, not fetched.
Exit 1 with a line for each fault.
"""

import html.parser
import pathlib
import re
import sys
import urllib.parse

STYLE_URL = re.compile(r"""(?:@import\s+(?:url\()?|url\()\s*['"]?([^'")\s;]+)""")
LOADED = {("script", "src"), ("img", "src"), ("iframe", "src"), ("source", "src"), ("object", "data")}


class Page(html.parser.HTMLParser):
    """The anchors of a page, what it links to and loads, and the links of its navigation."""

    def __init__(self, text):
        super().__init__()
        self.anchors, self.links, self.loads, self.navigation, self.depth = set(), [], [], [], 0
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        values = dict(attributes)
        self.anchors.update(values[name] for name in ("id", "name") if values.get(name))
        if tag == "div" and (self.depth or "sidebar-tree" in (values.get("class") or "").split()):
            self.depth += 1
        if tag == "a" and values.get("href") is not None:
            self.links.append(values["href"])
            if self.depth:
                self.navigation.append(values["href"])
        if tag == "link" and values.get("href"):
            (self.loads if values.get("rel") in ("stylesheet", "icon") else self.links).append(values["href"])
        self.loads += [values[name] for of_tag, name in LOADED if of_tag == tag and values.get(name)]

    def handle_endtag(self, tag):
        if tag == "div" and self.depth:
            self.depth -= 1


class Site:
    """All pages of a folder, and what is wrong with them."""

    def __init__(self, folder):
        self.folder = folder
        self.pages = {path: Page(path.read_text(encoding="utf-8")) for path in sorted(folder.rglob("*.html"))}
        self.faults, self.external, self.checked = [], set(), 0

    def complain(self, path, what):
        self.faults.append(f"{path.relative_to(self.folder)}: {what}")

    def follow(self, path, address, loaded):
        """One link of a page or style sheet."""
        parts = urllib.parse.urlsplit(address)
        if parts.scheme in ("data", "mailto"):
            return
        if parts.scheme or parts.netloc:
            if loaded:
                self.complain(path, f"loads {address} from outside")
            else:
                self.external.add(address)
            return
        self.checked += 1
        if parts.path.startswith("/"):
            self.complain(path, f"{address} begins at the root of a server")
            return
        target = (path.parent / urllib.parse.unquote(parts.path)).resolve() if parts.path else path
        if not target.is_file() or self.folder not in target.parents:
            self.complain(path, f"{address} is not in the site")
        elif parts.fragment and target in self.pages:
            if urllib.parse.unquote(parts.fragment) not in self.pages[target].anchors:
                self.complain(path, f"{address}: no such anchor")

    def follow_all(self):
        for path, page in self.pages.items():
            for address in page.links:
                self.follow(path, address, loaded=False)
            for address in page.loads:
                self.follow(path, address, loaded=True)
        for path in sorted(self.folder.rglob("*.css")):
            for address in STYLE_URL.findall(path.read_text(encoding="utf-8")):
                self.follow(path, address, loaded=True)

    def reach_all(self, docs):
        """Every page of docs/ is built and in the navigation of the first page."""
        first = self.folder / "index.html"
        if first not in self.pages:
            self.faults.append("index.html: there is none")
            return
        reached = {(self.folder / urllib.parse.urlsplit(link).path).resolve() for link in self.pages[first].navigation}
        for source in sorted(docs.rglob("*.md")):
            if source == docs / "README.md":
                continue
            page = self.folder / source.relative_to(docs).with_suffix(".html")
            if page not in self.pages:
                self.faults.append(f"docs/{source.relative_to(docs)}: no page in the site")
            elif page not in reached:
                self.faults.append(f"docs/{source.relative_to(docs)}: not in the navigation; docs/README.md lists the pages")


def main():
    if len(sys.argv) not in (2, 3) or sys.argv[1].startswith("-"):
        print(__doc__.strip(), file=sys.stderr)
        return 2
    folder = pathlib.Path(sys.argv[1]).resolve()
    root = pathlib.Path(sys.argv[2]).resolve() if len(sys.argv) == 3 else pathlib.Path(__file__).resolve().parents[2]
    site = Site(folder)
    site.follow_all()
    site.reach_all(root / "docs")
    for address in sorted(site.external):
        print(f"external, not fetched: {address}")
    for fault in site.faults:
        print(f"check_site: {fault}", file=sys.stderr)
    print(f"{len(site.pages)} pages, {site.checked} links inside, {len(site.external)} to the web, {len(site.faults)} faults")
    return 1 if site.faults else 0


if __name__ == "__main__":
    sys.exit(main())
