# The site of these pages: tools/scripts/make_site.sh builds it, without a network. The pages are the Markdown of docs/ and of
# the root as it is; tools/site makes of it links between pages and what a code host does not have (the navigation, the reference of the public headers).
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "tools" / "site"))

project = "gdtslam"
copyright = "the authors of gdtslam, BSD-3-Clause"  # noqa: A001 (Sphinx's name)
version = re.search(r"project\(gdtslam\s+VERSION\s+(\S+)", (ROOT / "CMakeLists.txt").read_text(encoding="utf-8")).group(1)
language = "en"

extensions = ["myst_parser", "breathe", "repository", "navigation", "header_pages", "appearance"]
root_doc = "index"  # docs/README.md: see tools/site/repository.py
include_patterns = ["docs/**.md", "CHANGELOG.md", "CONTRIBUTING.md", "SECURITY.md", "*/README.md"]
exclude_patterns = ["build*", "runs", ".*", "docs/**/.*"]

myst_heading_anchors = 4
myst_enable_extensions = []
pygments_style = "tango"
pygments_dark_style = "native"
highlight_language = "text"

breathe_default_project = "gdtslam"
breathe_default_members = ("members",)
cpp_maximum_signature_line_length = 100

html_theme = "furo"
html_title = f"gdtslam {version}"
html_static_path = ["../tools/site/static"]
html_css_files = ["site.css"]
html_js_files = ["site.js"]
html_copy_source = False
html_show_sphinx = False
html_theme_options = {"navigation_with_keys": False}
