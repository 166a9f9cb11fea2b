"""The help at the width of a terminal, option texts, manual pages, and what shells complete: by the shells themselves."""

import fcntl
import json
import os
import pathlib
import pty
import re
import select
import shutil
import struct
import subprocess
import termios
import time

import cli_support as cli
from cli_support import PROGRAM, RUN, SLOWNESS, SOURCE, command, expect, expect_exit, fresh_folder, skip


def commands_below(*words):
    """All commands, as their words: those of the help, and below each of them."""
    text = command(*words, "--help").stdout.split("Examples:")[0].split("Arguments:")[0]
    names = re.findall(r"^  ([a-z]+) ", text, re.MULTILINE)
    return [list(words)] + [found for name in names for found in commands_below(*words, name)]


def need(*programs):
    """Skips where one of the programs is not there; fails when GDTSLAM_REQUIRE_PROGRAMS=1."""
    missing = [program for program in programs if shutil.which(program) is None]
    if missing:
        expect(os.environ.get("GDTSLAM_REQUIRE_PROGRAMS") != "1", f"GDTSLAM_REQUIRE_PROGRAMS=1 and not there: {missing}")
        skip(f"not there: {missing}")


def help_fits_the_terminal():
    """Help of the commands at several widths: no line is wider, no word is broken, nothing of the parser shows; a terminal
    gives its width by itself."""
    commands = commands_below()
    expect(["map"] in commands and ["fleet", "run"] in commands, f"commands: {commands}")
    few = [[], ["map"]]
    for columns, most, shown in ((60, 60, commands), (100, 100, commands), (300, 100, few), ("wide", 80, few), (None, 80, few)):
        for words in shown:
            variable = None if columns is None else str(columns)
            process = command(*words, "--help", env=cli.environment(COLUMNS=variable))
            expect_exit(process, 0)
            for line in process.stdout.splitlines():
                is_one_word = len(line.split()) <= 2  # such as a list of numbers that is a default, or a quoted example
                expect(len(line) <= most or is_one_word, f"{words} at {columns}: {len(line)} columns: {line!r}")
            for noise in ("Excludes:", "Needs:", "INT in", "FLOAT in", "REQUIRED", "{false}"):
                expect(noise not in process.stdout, f"{words}: {noise!r} in the help")
    words = re.sub(r"\s+", "", command("map", "--help", env=cli.environment(COLUMNS="60")).stdout.replace("\\\n", ""))
    wide = re.sub(r"\s+", "", command("map", "--help", env=cli.environment(COLUMNS="100")).stdout.replace("\\\n", ""))
    expect(words == wide, "another width has other words")
    ours, theirs = pty.openpty()
    fcntl.ioctl(theirs, termios.TIOCSWINSZ, struct.pack("HHHH", 40, 66, 0, 0))
    process = subprocess.Popen([PROGRAM, "map", "--help"], stdout=theirs, stderr=theirs, env=cli.environment(COLUMNS=None))
    os.close(theirs)
    shown = read_all(ours).replace("\r", "")
    expect(process.wait(timeout=60 * cli.SLOWNESS) == 0, "help on a terminal")
    expect(shown == command("map", "--help", env=cli.environment(COLUMNS="66")).stdout, f"not 66 columns wide: {shown}")


# How a text begins that needs the one before it to be understood.
TAIL = re.compile(r"(And|Or|Of|With what|Likewise|Instead|Such|So|Also|But|The same|Then|Else|Ditto)\b")


def expect_sentence(where, text):
    expect(re.match(r"[A-Z0-9]", text), f"{where}: does not begin as a sentence: {text!r}")
    expect(not TAIL.match(text), f"{where}: the tail of another text: {text!r}")
    expect(not text.endswith((".", ",", ";", ":")), f"{where}: ends with {text[-1]!r}: {text!r}")
    expect(len(text.split()) >= 2 and len(text) >= 10, f"{where}: says nothing alone: {text!r}")
    expect(not re.search(r"\b(next|previous) (one|two|three|option)s?\b", text), f"{where}: names a neighbour: {text!r}")


def option_texts_stand_alone():
    """Each option's text is a sentence that is understood without its neighbour: in the settings and in every command."""
    rows = json.loads(command("config", "show", "--all", "--json").stdout)
    expect(len(rows) > 90, f"{len(rows)} options")
    for row in rows:
        expect_sentence(row["path"], row["doc"])
    texts = [row["doc"] for row in rows]
    expect(len(set(texts)) == len(texts), f"said twice: {sorted(t for t in texts if texts.count(t) > 1)}")
    schema = json.loads(command("config", "schema").stdout)
    expect(schema["properties"]["keyframe"]["properties"]["angle"]["description"] in texts, "the schema has other texts")
    count = 0
    for words in commands_below():
        text = command(*words, "--help", env=cli.environment(COLUMNS="100")).stdout.split("\n\nExamples:")[0]
        for option, doc in re.findall(r"^  (-\S.*?)(?:  +|\n +)(\S.*\n(?: {6,}.*\n)*)", text, re.MULTILINE):
            expect_sentence(f"{words} {option}", re.sub(r" \((?:default|required|with|\d)[^()]*(?:\([^()]*\)[^()]*)*\)$", "", " ".join(doc.split())))
            count += 1
    expect(count > 280, f"only {count} options were found in the help")


def config_show_of_a_part():
    """A filter finds options by path, by text and by glob, in any form of output; angles are in degrees; what fits nowhere
    gets a hint."""
    def paths(*arguments):
        process = command("config", "show", *arguments)
        expect_exit(process, 0)
        return re.findall(r"^([a-z_.]+) +=", process.stdout, re.MULTILINE)
    everything = paths("--all")
    expect(set(paths()) < set(everything) and 20 < len(paths()) <= 40, "the usual options")
    expect(paths("keyframe.") == [p for p in everything if p.startswith("keyframe.")] != [], "by path")
    expect(paths("KEYFRAME.Angle") == ["keyframe.angle"], "upper and lower case")
    expect(paths("log.mount*") == ["log.mount", "log.mount_x", "log.mount_y", "log.mount_angle"], "by glob")
    expect("doubt.suspect_overlap" in paths("window"), "by text")
    expect(paths("resolution", "--set", "map.resolution=10cm") == ["map.resolution"], "with --set")
    text = command("config", "show", "search.step_angle").stdout
    expect(re.search(r"= 2\.00535 deg\n.*\n +default 2\.00535 deg; allowed 0\.0286479 deg to 180\.482 deg;", text), text)
    everything_shown = command("config", "show", "--all").stdout
    expect(not re.search(r"[0-9] rad\b", everything_shown), "an angle in radians")
    row, = json.loads(command("config", "show", "search.step_angle", "--json").stdout)
    expect(row["value"] == "0.035 rad", f"JSON has the exact value: {row}")
    expect(command("config", "show", "keyframe.", "--yaml").stdout.count(":\n") == 1, "one section of the file")
    process = command("config", "show", "keyfrme")
    expect_exit(process, 2)
    expect("no option has 'keyfrme' in its path or its text; did you mean 'keyframe'?" in process.stderr, process.stderr)


def manual_pages():
    """A page of each command by help2man, which man shows without a complaint, with every option; the same bytes on any day."""
    need("help2man", "man")
    folder = fresh_folder("manual")
    again = cli.environment(LC_ALL="C", TZ="Asia/Tokyo", COLUMNS="40")
    for name in ("", "map", "linkage"):
        pages = []
        for place, env in (("a", None), ("b", again)):
            (folder / place).mkdir(exist_ok=True)
            subprocess.run([SOURCE / "tools/scripts/man_page.sh", PROGRAM, folder / place, *name.split()], check=True, env=env)
            pages.append(folder / place / f"gdtslam{'-' * bool(name)}{name}.1")
        expect(pages[0].read_bytes() == pages[1].read_bytes(), f"{name}: depends on width, language or time zone")
        shown = subprocess.run(["man", "--warnings", "-E", "UTF-8", "-l", pages[0]], capture_output=True, text=True, check=False,
                               env=cli.environment(LC_ALL="C.UTF-8", MANWIDTH="80", MAN_KEEP_FORMATTING=None))
        expect(shown.returncode == 0 and shown.stderr == "", f"{name}: {shown.stderr}")
        for option in re.findall(r"^  ((?:-[a-z], )?--[a-z-]+)", command(*name.split(), "--help").stdout, re.MULTILINE):
            expect(option in shown.stdout, f"{name}: the page lacks {option}")


def completion_folder(name):
    """A folder with a log, a cloud and a folder, where files are completed, and the two scripts beside it."""
    folder = fresh_folder(name)
    place = folder / "place"
    (place / "runs").mkdir(parents=True)
    for file in ("drive.log", "drive.clf.gz", "cloud.ply", "notes.txt"):
        (place / file).write_text("")
    for shell, file in (("bash", "gdtslam.bash"), ("zsh", "_gdtslam")):
        (folder / file).write_text(command("generate", "completion", shell).stdout)
    return folder


# What is typed, what must be offered, what must not be.
CASES = (
    ("gdtslam ", {"map", "doctor", "generate"}, {"drive.log"}),
    ("gdtslam ma", {"map"}, {"merge"}),
    ("gdtslam fleet ", {"run", "finish"}, {"map"}),
    ("gdtslam map --ma", {"--matcher"}, {"--lenient"}),
    ("gdtslam map --matcher ", {"simplex", "certified", "gauss-newton"}, {"--matcher", "drive.log"}),
    ("gdtslam map drive.log --matcher sim", {"simplex", "simpsa"}, {"certified"}),
    ("gdtslam map --device v", {"vulkan"}, {"cpu"}),
    ("gdtslam map --set merge.", {"merge.kappa=", "merge.rule=", "merge.threshold="}, {"map.resolution="}),
    ("gdtslam map ", {"drive.log", "drive.clf.gz"}, {"cloud.ply", "notes.txt"}),
    ("gdtslam doctor --after ", {"runs"}, {"drive.log"}),
    ("gdtslam map --linkage pap", {"paper-a", "paper-b"}, {"drive.log"}),
    ("gdtslam generate completion ", {"bash", "zsh"}, {"drive.log"}),
    ("gdtslam config show --", {"--yaml", "--json"}, {"--matcher"}),
    ("gdtslam help co", {"config", "convert"}, {"map"}),
)
SETTING = "gdtslam map --set map.transform="
WITH_PROGRAM = {"PATH": f"{pathlib.Path(PROGRAM).parent}:{os.environ['PATH']}"}


def expect_offers(shell, line, offered, wanted, unwanted):
    expect(wanted <= offered and not unwanted & offered, f"{shell}: {line!r} offers {sorted(offered)}, not {sorted(wanted)}")


def completion_of_bash():
    """bash completes commands, options and values."""
    need("bash")
    folder = completion_folder("complete_bash")
    script = """
        . "$1"
        COMP_LINE=$2 COMP_POINT=${#2} COMP_TYPE=9 COMP_KEY=9
        # The words as readline has them: '=' and ':' stand alone.
        read -ra COMP_WORDS <<<"$(sed 's/[=:]/ & /g' <<<"$2")"
        [[ $2 == *[[:blank:]=:] ]] && COMP_WORDS+=("")
        COMP_CWORD=$((${#COMP_WORDS[@]} - 1))
        _gdtslam gdtslam "${COMP_WORDS[COMP_CWORD]}" "${COMP_WORDS[COMP_CWORD-1]}"
        printf '%s\\n' "${COMPREPLY[@]}"
    """

    def offers(line):
        process = subprocess.run(["bash", "--norc", "-c", script, "bash", folder / "gdtslam.bash", line],
                                 cwd=folder / "place", capture_output=True, text=True, check=False, stdin=subprocess.DEVNULL,
                                 env=cli.environment(**WITH_PROGRAM))
        said = [text for text in process.stderr.splitlines() if "compopt: not currently executing" not in text]
        expect(process.returncode == 0 and not said, f"{line!r}: {said}")
        return set(process.stdout.split())

    for line, wanted, unwanted in CASES:
        expect_offers("bash", line, offers(line), wanted, unwanted)
    expect_offers("bash", SETTING, offers(SETTING), {"exact", "jump-flood"}, {"true"})
    expect_offers("bash", "--matcher=", offers("gdtslam map --matcher=cer"), {"certified"}, {"simplex"})
    expect(offers("gdtslam map --first ") == set(), "a count is no file")


def read_all(terminal):
    """What comes until the other end is closed."""
    shown = b""
    try:
        while chunk := os.read(terminal, 65536):
            shown += chunk
    except OSError:  # the other end is closed
        pass
    return shown.decode()


# What zsh is told before keys are pressed. Each word that a completion adds goes to a file too: what a terminal shows of
# it depends on its size and on when it is read. Calls that fill an array of their caller add nothing.
ZSHRC = r"""
fpath=(%(folder)s $fpath); autoload -Uz compinit; compinit -u -D; setopt list_ambiguous
compadd() {
  local -a found
  if [[ " $* " != *" -"[OAD]" "* ]]; then
    builtin compadd -O found "$@"
    print -rl -- $found >>%(folder)s/offered
  fi
  builtin compadd "$@"
}
offer-and-tell() { zle list-choices; : >%(folder)s/told; zle kill-whole-line }
zle -N offer-and-tell
bindkey '^T' offer-and-tell
"""


class Zsh:
    """An interactive zsh on a terminal of its own, in which keys are pressed."""

    def __init__(self, folder):
        self.folder = folder
        (folder / ".zshrc").write_text(ZSHRC % {"folder": folder})
        self.terminal, theirs = pty.openpty()
        fcntl.ioctl(theirs, termios.TIOCSWINSZ, struct.pack("HHHH", 500, 200, 0, 0))
        self.process = subprocess.Popen(
            ["zsh", "-d", "-i"], stdin=theirs, stdout=theirs, stderr=theirs, cwd=folder / "place", start_new_session=True,
            env=cli.environment(**WITH_PROGRAM, TERM="dumb", HOME=str(folder), ZDOTDIR=str(folder)))
        os.close(theirs)

    def offers(self, line):
        """The words that are offered behind the line."""
        for name in ("offered", "told"):
            (self.folder / name).unlink(missing_ok=True)
        os.write(self.terminal, line.encode() + b"\x14")
        shown, end = b"", time.monotonic() + 60 * SLOWNESS
        while not (self.folder / "told").exists():
            expect(time.monotonic() < end, f"zsh does not come to an end: {shown!r}")
            if select.select([self.terminal], [], [], 0.05)[0]:
                shown += os.read(self.terminal, 65536)
        offered = self.folder / "offered"
        return set(offered.read_text().split()) if offered.exists() else set()

    def close(self):
        self.process.kill()
        self.process.wait()
        os.close(self.terminal)


def completion_of_zsh():
    """zsh completes commands, options and values."""
    need("zsh")
    folder = completion_folder("complete_zsh")
    zsh = Zsh(folder)
    try:
        for line, wanted, unwanted in CASES:
            expect_offers("zsh", line, zsh.offers(line), wanted, unwanted)
        expect_offers("zsh", SETTING, zsh.offers(SETTING), {"map.transform=exact", "map.transform=jump-flood"}, {"map.transform=true"})
    finally:
        zsh.close()


def version_names_the_commit():
    """--version has the version alone on its first line, then the commit; results have the version only."""
    lines = command("--version").stdout.splitlines()
    expect(re.fullmatch(r"gdtslam \d+\.\d+\.\d+", lines[0]), f"{lines}")
    expect(re.fullmatch(r"commit    ([0-9a-f]{12}(, changed)? of \d{4}-\d\d-\d\d|unknown|\S+)", lines[1]), f"{lines}")
    expect(lines[2].startswith("built with ") and "instruction set" in lines[3], f"{lines}")
    version = lines[0].split()[1]
    report = json.loads((RUN / "report.json").read_text())
    expect(report["version"] == version, f"report.json: {report['version']}")
