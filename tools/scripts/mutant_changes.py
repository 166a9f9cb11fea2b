"""What is changed in a line of C++ to make a mutant of it, and which lines are drawn (mutants.py)."""

import pathlib
import re
import subprocess

ROOT = pathlib.Path(__file__).resolve().parents[2]
WHOLE_NUMBER = r"(?<![\w.'])(\d+)(?=U?\b(?!\.|'|[a-zA-Z]))"
DECIMAL = r"(?<![\w.'])(\d+\.\d*(?:e[+-]?\d+)?|\d+e[+-]?\d+)(?![\w.'])"
# A value whose name says that it is an angle, where it is read: not behind a type, & or *, not in front of an assignment.
ANGLE = (r"(?<![\w.&*>~-])(?<!double )(?<!float )(?<!_t )(?<!auto )(?<!const )((?:\w+(?:\[\w+\])?(?:\.|->))*"
         r"(?:\w*_rad|\w*theta|\w*yaw|\w*bearing|\w*heading)_?)(?=\)|,|;| [-+*/<>] )")

# The kind, the pattern of the code, what takes its place where a table says it. As clang-format leaves the code, an operator
# between two values has blanks around it, and brackets of templates have none. Room that is reserved or not changes nothing.
CHANGES = [
    ("comparison", re.compile(r" (<|<=|>|>=|==|!=) "), {"<": "<=", "<=": "<", ">": ">=", ">=": ">", "==": "!=", "!=": "=="}),
    ("sign", re.compile(r"(?<=[\w)\]]) ([+-]|[+-]=) "), {"+": "-", "-": "+", "+=": "-=", "-=": "+="}),
    ("sign of an angle", re.compile(ANGLE), None),
    ("one off", re.compile(WHOLE_NUMBER), None),
    ("bound", re.compile(DECIMAL), None),
    ("logic", re.compile(r" (&&|\|\|) "), {"&&": "||", "||": "&&"}),
    ("extremum", re.compile(r"std::(min|max)(?=\()"), {"min": "max", "max": "min"}),
    ("condition", re.compile(r"^\s*(?:\} else )?if (\()(?!constexpr)(?=.*\)(?: \{| \w.*;)$)"), {"(": "(!"}),
    ("dropped call", re.compile(r"^\s+((?!return|throw|delete|co_|using|static_assert|assert)(?!\S+\.reserve\()[\w.:>-]+\(.*\);)$"),
     None),
    ("dropped sync", re.compile(r"(::(?:fsync|fdatasync|syncfs)\([^()]*(?:\([^()]*\))?[^()]*\))"), {}),
    ("dropped lock", re.compile(r"(::flock\([^()]*(?:\([^()]*\))?[^()]*\))"), {}),
    ("dropped lock", re.compile(r"^\s+((?:const )?std::(?:lock_guard|scoped_lock|unique_lock)\b.*;)$"), None),
]
KINDS = tuple(dict.fromkeys(kind for kind, _, _ in CHANGES))


class Mutant:
    """One change: of a line (from 1) of a file, the characters from begin to end become text."""

    def __init__(self, path, line, kind, begin, end, text, old):
        self.path, self.line, self.kind, self.begin, self.end, self.text, self.old = pathlib.Path(path), line, kind, begin, end, text, old

    @property
    def new(self):
        return self.old[:self.begin] + self.text + self.old[self.end:]

    def source(self):
        """The whole source with the change."""
        lines = (ROOT / self.path).read_text().splitlines()
        lines[self.line - 1] = self.new
        return "\n".join(lines) + "\n"

    @property
    def key(self):
        """What it is, whatever the number of its line."""
        return f"{self.path}: {self.kind}: {self.old.strip()}  ->  {self.new.strip()}"

    def describe(self):
        return self.key.replace(":", f":{self.line}:", 1)


def code_of(line):
    """The line with comments and texts blanked, so that places stay."""
    line = re.sub(r'"(?:[^"\\]|\\.)*"', lambda m: " " * len(m[0]), line)
    return re.sub(r"//.*", lambda m: " " * len(m[0]), line)


def negated(line, begin):
    """The end of the condition whose bracket opens at begin: `if (a && b)` becomes `if (!(a && b))`."""
    depth = 0
    for place in range(begin, len(line)):
        depth += {"(": 1, ")": -1}.get(line[place], 0)
        if depth == 0:
            return place
    return None


def put_in_place(kind, match, table, line):
    """The end and the text of what takes the place of a match; None where nothing can."""
    begin, end = match.span(1)
    old = match[1]
    if kind == "one off":
        return [(end, str(int(old, 8 if re.match(r"0\d", old) else 10) + 1))]
    if kind == "bound":
        value = float(old)
        return [(end, repr(other)) for other in ([2 * value, value / 2] if value else [1.0])]
    if kind == "sign of an angle":
        return [(end, f"-{old}")]
    if kind == "dropped sync" or old.startswith("::flock"):
        return [(end, "0")]
    if kind in ("dropped call", "dropped lock"):
        return [(end, ";")]
    if kind == "condition":
        close = negated(code_of(line), begin)
        return [] if close is None else [(close + 1, "(!" + line[begin:close + 1] + ")")]
    return [(end, table[old])]


def mutants_of_line(path, number, line, kinds=KINDS):
    code = code_of(line)
    stripped = code.strip()
    if not stripped or stripped.startswith(("#", "template", "using", "static_assert", "assert(", "/*", "*", "case ")):
        return
    for kind, pattern, table in CHANGES:
        if kind in kinds:
            for match in pattern.finditer(code):
                for end, text in put_in_place(kind, match, table, line):
                    yield Mutant(path, number, kind, match.start(1), end, text, line)


def sources_of(folder, without=()):
    """The sources under a folder. Headers are left out: their code is compiled into many objects, those of tests among them."""
    listed = subprocess.run(["git", "-C", ROOT, "ls-files", folder], capture_output=True, text=True, check=True).stdout
    return [pathlib.Path(name) for name in listed.splitlines() if name.endswith((".cpp", ".inl")) and not name.startswith(tuple(without))]


def drawn(sources, count, rng, kinds=KINDS):
    """Mutants of as many lines drawn at random, no line twice; what a line offers is drawn among, too."""
    places = []
    for path in sources:
        for number, line in enumerate((ROOT / path).read_text().splitlines(), 1):
            offered = list(mutants_of_line(path, number, line, kinds))
            if offered:
                places.append(offered)
    return [rng.choice(offered) for offered in rng.sample(places, min(count, len(places)))]


def found_again(recorded):
    """The mutant of an earlier run in the source as it is now: the nearest line of the same text; None where it is gone."""
    if not (ROOT / recorded["path"]).exists():
        return None
    lines = (ROOT / recorded["path"]).read_text().splitlines()
    near = [number for number, line in enumerate(lines, 1) if line == recorded["old"]]
    if not near:
        return None
    line = min(near, key=lambda number: abs(number - recorded["line"]))
    return Mutant(recorded["path"], line, recorded["kind"], recorded["begin"], recorded["end"], recorded["text"], recorded["old"])


def equivalent_mutants(file):
    """The reasons by key: each entry of the file is a line with the key and one, indented, with the reason."""
    reasons, key = {}, None
    for line in file.read_text().splitlines() if file.exists() else ():
        if line.startswith("#") or not line.strip():
            continue
        if line[0].isspace():
            reasons[key] = line.strip()
        else:
            key = line
    return reasons
