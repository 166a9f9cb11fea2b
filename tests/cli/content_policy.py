"""What a page may do by its content security policy, checked from outside: only scripts of the page's own, by their hash."""

import base64
import hashlib
import html.parser
import re


class Inline(html.parser.HTMLParser):
    """The scripts that run, the styles, the policy, and attributes that would run or style something."""

    def __init__(self, text):
        super().__init__(convert_charrefs=False)
        self.scripts, self.styles, self.policy, self.faults = [], [], None, []
        self.kept = None
        self.feed(text)
        self.close()

    def handle_starttag(self, tag, attributes):
        given = dict(attributes)
        self.faults += [f"<{tag} {name}>" for name in given if name.startswith("on") or name == "style"]
        self.faults += [f"<{tag} src>" for name in given if tag == "script" and name == "src"]
        if tag == "meta" and given.get("http-equiv", "").lower() == "content-security-policy":
            self.policy = given["content"]
        if tag == "script" and given.get("type", "module") in ("module", "text/javascript"):
            self.kept = []
            self.scripts.append(self.kept)
        if tag == "style":
            self.kept = []
            self.styles.append(self.kept)

    def handle_endtag(self, tag):
        if tag in ("script", "style"):
            self.kept = None

    def handle_data(self, data):
        if self.kept is not None:
            self.kept.append(data)


def source_of(pieces):
    """The source expression of an element's text, as a browser computes it."""
    return "'sha256-" + base64.b64encode(hashlib.sha256("".join(pieces).encode()).digest()).decode() + "'"


def faults_of(page, policy=None):
    """What is wrong with the policy of a page: that of a header, else that of the page itself."""
    inline = Inline(page)
    policy = policy or inline.policy
    if not policy:
        return ["no policy"]
    rules = {rule.split()[0]: rule.split()[1:] for rule in policy.split(";") if rule.strip()}
    faults = list(inline.faults)
    if rules.get("default-src") != ["'none'"]:
        faults.append(f"default-src {rules.get('default-src')}")
    for rule, elements in (("script-src", inline.scripts), ("style-src", inline.styles)):
        sources = rules.get(rule, [])
        if sorted(sources) != sorted({source_of(element) for element in elements}):
            faults.append(f"{rule} {sources}, and the page has {[source_of(element) for element in elements]}")
    for rule, sources in rules.items():
        faults += [f"{rule} {source}" for source in sources if source == "*" or re.match("https?:|wss?:", source)]
    if not inline.scripts:
        faults.append("no script")
    return faults
