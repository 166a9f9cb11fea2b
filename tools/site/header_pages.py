"""The reference of the public headers: a page for each part, with what Doxygen's XML says of each of its headers.

docs/Doxyfile names the folders of headers; docs/reference/api.md has a row for each part, which is where its description
comes from. The pages are made in the folder of the build, not in docs/.

Doxygen puts functions, types and constants of a namespace into the file of the namespace, where Breathe looks for them once
for each header and finds the namespace declared again each time. So they are moved to the file of their header first, in the
order of their lines, and the namespace is left out.
"""

import pathlib
import re
import subprocess
import xml.etree.ElementTree

from sphinx.errors import ExtensionError

OVERVIEW = "docs/reference/api.md"
ROW = re.compile(r"^\| \[([\w ]+)\]\(([^)]+)\) \| (.+?) \|", re.MULTILINE)


def doxyfile_of(root):
    return (root / "docs" / "Doxyfile").read_text(encoding="utf-8")


def folders_of(root):
    """The folders of public headers that the Doxyfile names."""
    return re.search(r"^INPUT = ((?:.*\\\n)*.*)$", doxyfile_of(root), re.MULTILINE).group(1).replace("\\\n", " ").split()


def headers_of(root, folder):
    return sorted(path for path in (root / folder).rglob("*") if path.suffix in (".hpp", ".h"))


def run_doxygen(root, output):
    """XML in output/xml instead of the pages in HTML."""
    settings = (doxyfile_of(root) + f'\nOUTPUT_DIRECTORY = "{output}"\nGENERATE_HTML = NO\nGENERATE_XML = YES\n'
                "XML_PROGRAMLISTING = NO\n")
    output.mkdir(parents=True, exist_ok=True)
    done = subprocess.run(["doxygen", "-"], input=settings, cwd=root, text=True, capture_output=True, check=False)
    if done.returncode != 0:
        raise ExtensionError(f"doxygen ended with {done.returncode}:\n{done.stderr}")


def readable(element):
    """Two forms of a default value that Sphinx's parser of C++ does not know: digits in groups, designated members."""
    for value in element.iter():
        if value.tag in ("argsstring", "defval", "initializer") and value.text:
            value.text = re.sub(r"(?<=\d) ?'(?=\d)", "", value.text)
            if re.match(r"=? ?\{ ?\.", value.text):
                value.text = "= {}" if value.text.startswith("=") else "{}"


def move_members(folder):
    """Members of namespaces go to the file of their header."""
    members = {}
    for path in sorted(folder.glob("namespace*.xml")):
        compound = xml.etree.ElementTree.parse(path).find("compounddef")
        for member in compound.iter("memberdef"):
            place, name = member.find("location"), member.find("name")
            name.text = f"{compound.findtext('compoundname')}::{name.text}"
            members.setdefault(place.get("file"), []).append((int(place.get("line")), member))
    for path in sorted(folder.glob("*.xml")):
        tree = xml.etree.ElementTree.parse(path)
        compound = tree.find("compounddef")
        if compound is None:
            continue
        if compound.get("kind") == "file":
            for namespace in compound.findall("innernamespace"):
                compound.remove(namespace)
            section = xml.etree.ElementTree.Element("sectiondef", kind="user-defined")
            found = sorted(members.get(compound.find("location").get("file"), []), key=lambda entry: entry[0])
            xml.etree.ElementTree.SubElement(section, "header").text = "Functions, types and constants"
            section.extend(member for _, member in found)
            if found:
                compound.insert(list(compound).index(compound.find("briefdescription")), section)
        for include in compound.findall("includes"):  # of a class: Doxygen gives the name without its folders
            include.text = re.sub(r"^.*/include/", "", compound.find("location").get("file"))
        readable(compound)
        tree.write(path, encoding="utf-8", xml_declaration=True)


def opening_of(header):
    """The comment at the top of a header as Markdown, with links to the pages it names."""
    lines = []
    for line in header.read_text(encoding="utf-8").split("\n"):
        if not line.startswith("//"):
            break
        lines.append(line[2:].strip())
    text = re.sub(r"([\\*_\[\]<>#|])", r"\\\1", "\n".join(lines))
    return re.sub(r"\bdocs/([\w/.-]+\.md)\b", lambda match: f"[docs/{match.group(1)}](/docs/{match.group(1)})",
                  text.replace("\\_", "_"))


def page_of(root, folder, name, description):
    lines = [f"# {name}", "", description[0].upper() + description[1:] + ".", ""]
    for header in headers_of(root, folder):
        path = header.relative_to(root / folder).as_posix()
        lines += [f"## {path}", "", opening_of(header), "", f"```{{doxygenfile}} {path}", "```", ""]
    return "\n".join(lines)


def parts_of(root):
    """(folder of headers, name, description) of each part, in the order of the overview; an error where they differ."""
    overview = root / OVERVIEW
    parts = []
    for name, link, description in ROW.findall(overview.read_text(encoding="utf-8")):
        folder = (overview.parent / link).resolve().relative_to(root).as_posix()
        parts.append((re.sub(r"/gdtslam/\w+$", "", folder), name, description))
    missing = set(folders_of(root)) ^ {folder for folder, _, _ in parts}
    if missing:
        raise ExtensionError(f"{OVERVIEW} and docs/Doxyfile do not name the same folders: {', '.join(sorted(missing))}")
    return parts


def begin(app):
    root, work = pathlib.Path(app.srcdir), pathlib.Path(app.doctreedir).parent
    run_doxygen(root, work)
    move_members(work / "xml")
    pages = work / "made" / "reference" / "api"
    pages.mkdir(parents=True, exist_ok=True)
    app.header_pages = {}
    for folder, name, description in parts_of(root):
        app.header_pages[folder] = f"reference/api/{name}"
        (pages / f"{name}.md").write_text(page_of(root, folder, name, description), encoding="utf-8")
    for path in pages.glob("*.md"):
        if f"reference/api/{path.stem}" not in app.header_pages.values():
            path.unlink()


def add_pages(app, docname, source):
    """The overview's rows lead to the pages of the parts, which its navigation lists."""
    if docname != "reference/api":
        return
    source[0] = ROW.sub(lambda row: row.group(0).replace(f"({row.group(2)})", f"(api/{row.group(1)}.md)"), source[0])
    source[0] += "\n".join(["", "```{toctree}", ":hidden:", ""] + list("/" + page for page in app.header_pages.values()) + ["```"])


def place_xml(app, config):
    config.breathe_projects = {"gdtslam": str(pathlib.Path(app.doctreedir).parent / "xml")}


def setup(app):
    app.connect("config-inited", place_xml)
    app.connect("builder-inited", begin, priority=200)
    app.connect("source-read", add_pages)
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": True}
