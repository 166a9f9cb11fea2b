"""The built site in a real browser, from its folder: quiet, nothing from outside, no page wider than a phone, the search.

  site_browser_test.py SITE
"""

import os
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "cli" / "browser"))
import chromium  # noqa: E402

PHONE = 390
SKIPPED = 77
# Words with a page that has to be among the results, and one that no page has.
SEARCHES = {"truncation": "reference/options.html", "loop_search_maximum_distance": "howto/coming-from.html",
            "LoopClosing": "reference/api/mapping.html", "qqzzxx": None}


def pages_of(site):
    return sorted(site.rglob("*.html"))


def open_page(browser, path, query=""):
    browser.requests.clear()
    browser.errors.clear()
    browser.call("Page.navigate", url=path.as_uri() + query)
    browser.wait_for("document.readyState === 'complete' && location.href !== 'about:blank'")


def faults_of_pages(browser, site):
    """Every page at a phone's width; and whether it scrolls sideways, lacks a picture or says anything."""
    for path in pages_of(site):
        name = path.relative_to(site).as_posix()
        open_page(browser, path)
        wide = browser.value("document.documentElement.scrollWidth") - PHONE
        if wide > 0:
            yield f"{name}: {wide} pixels wider than a phone"
        missing = browser.value("[...document.images].filter(i => i.complete && i.naturalWidth === 0).map(i => i.src).join(' ')")
        if missing:
            yield f"{name}: no picture {missing}"
        yield from (f"{name}: {error}" for error in browser.errors)
        yield from (f"{name}: asks for {url}" for url in browser.requests if not url.startswith(("file://", "data:")))


def faults_of_search(browser, site):
    for word, wanted in SEARCHES.items():
        open_page(browser, site / "search.html", f"?q={word}")
        browser.wait_for("document.querySelector('#search-results p.search-summary') && "
                         "/found|match/.test(document.querySelector('#search-results p.search-summary').innerText)")
        found = browser.value("[...document.querySelectorAll('#search-results ul.search a')].map(a => a.href)")
        if wanted is None and found:
            yield f"search for {word}: found {found}"
        if wanted and not any(link.split("?")[0].split("#")[0].endswith(wanted) for link in found):
            yield f"search for {word}: {wanted} is not among {len(found)} results"
        yield from (f"search for {word}: {error}" for error in browser.errors)


def faults_of_colours(browser, site):
    """The ground of a page is dark where the reader's system is, and light elsewhere."""
    for scheme, is_right in (("light", lambda ground: ground > 600), ("dark", lambda ground: ground < 150)):
        browser.call("Emulation.setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": scheme}])
        open_page(browser, site / "index.html")
        ground = browser.value("getComputedStyle(document.body).backgroundColor.match(/\\d+/g).map(Number).reduce((a, b) => a + b)")
        if not is_right(ground):
            yield f"index.html, {scheme}: red, green and blue of the ground add up to {ground}"


def main():
    if len(sys.argv) != 2:
        print(__doc__.strip(), file=sys.stderr)
        return 2
    if chromium.find_program() is None:
        print("SKIPPED: chromium is not installed, so the site was NOT tested in a browser", flush=True)
        return 1 if os.environ.get("GDTSLAM_REQUIRE_BROWSER") == "1" else SKIPPED
    site = pathlib.Path(sys.argv[1]).resolve()
    with chromium.Browser(width=PHONE, height=844) as browser:
        faults = [*faults_of_pages(browser, site), *faults_of_search(browser, site), *faults_of_colours(browser, site)]
    for fault in faults:
        print(f"site: {fault}", file=sys.stderr)
    print(f"{len(pages_of(site))} pages and {len(SEARCHES)} searches in a browser, {len(faults)} faults")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
