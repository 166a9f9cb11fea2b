#!/usr/bin/env python3
"""Runs the commands that README.md and the pages of docs/ show and holds what they print against what the pages say.

  doc_outputs.py --check [--all] [--program GDTSLAM] [--share K/N] [PAGE...]    compares; 1 where something differs
  doc_outputs.py --write [--all] [--program GDTSLAM] [--share K/N] [PAGE...]    writes what they print now, if nothing is left out

A fenced block says by its language what it holds; a block without a language is an error.
  console   commands after '$ ' and what they print, standard output and standard error together. A line '...' stands for
            any number of lines. Where nothing is shown after a command, its output may be anything. A command that
            shows 'gdtslam: error: ' has to fail, every other one has to end with exit code 0.
  sh        commands to copy, run as one script that ends at the first one that fails, which none may.
  others    (text, yaml, cpp, ...) are not run.
A comment in the line above a block of commands says what is special about it:
  <!-- not run: REASON -->    it is never run, and is listed with its reason.
  <!-- slow: REASON -->       it is run with --all only.
Blocks that name a public log (intel, fr079, mit-csail) are run where the logs are: in the folder slam2d of GDTSLAM_DATA,
or of ../shared/data beside the clone. How many blocks were left out, and why, is printed.

The blocks of a page run in their order in a folder of the page's own. It holds runs/, as tools/run.sh makes it, the public
logs under their own names, and my.log, which stands for the reader's log.

What differs from machine to machine is not compared: see VARYING.
"""

import argparse
import difflib
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
PUBLIC_LOGS = re.compile(r"\b(?:intel|fr079|mit-csail)\b")
MARK = re.compile(r"<!-- (not run|slow): (.+) -->$")

# What of the output depends on the machine, and what takes its place before a comparison.
VARYING = [(re.compile(pattern), substitute) for pattern, substitute in (
    (r"^vulkan:\d+: .* against .*", "DEVICE against CPU"),
    (r"\b[\d.]+ s on the CPU, [\d.]+ s here", "TIME on the CPU, TIME here"),
    (r"^[\d.]+ s$", "TIME"),
    (r"\b[\d.]+ s of (?:processor|CPU) time\b", "TIME of processor time"),
    (r"\b[\d,.]+ scans/s\b", "RATE scans/s"),
    (r"\bgdtslam \d+\.\d+\.\d+\S*", "gdtslam VERSION"),
)]


class Block:
    """Commands of a page, each with the lines that the page shows after it."""

    def __init__(self, page, line, language, mark, reason):
        self.page, self.line, self.language, self.mark, self.reason = page, line, language, mark, reason
        self.commands = []  # (command, number of the line behind it, lines shown)

    def where(self):
        return f"{self.page}:{self.line}"

    def needs_logs(self):
        return any(PUBLIC_LOGS.search(command) for command, _, _ in self.commands)


def blocks_of(page, text):
    """The blocks of commands of a page; a ValueError where a block does not say what it is."""
    blocks, block, inside, before = [], None, False, ""
    lines = text.split("\n")
    for number, line in enumerate(lines, 1):
        if line.startswith("```"):
            if not inside:
                language, marked = line[3:].strip(), MARK.match(before)
                if not language:
                    raise ValueError(f"{page}:{number}: the block has no language: sh, console, text, ...")
                if marked and language not in ("sh", "console"):
                    raise ValueError(f"{page}:{number}: a block '{language}' is never run, so it takes no mark")
                if language in ("sh", "console"):
                    block = Block(page, number, language, *(marked.groups() if marked else (None, None)))
                    blocks.append(block)
            else:
                block = None
            inside = not inside
        elif block is not None:
            add_line(block, number, line)
        before = line
    if inside:
        raise ValueError(f"{page}: the last block does not end")
    return blocks


def add_line(block, number, line):
    """A line of a block: a command, the rest of one, or what the last command shows."""
    last = block.commands[-1][0] if block.commands else ""
    if last and (block.language == "sh" or last.endswith("\\")):
        block.commands[-1] = (f"{last}\n{line}", number, block.commands[-1][2])
    elif block.language == "sh":
        block.commands.append((f"set -e; trap 'echo \"failed: $BASH_COMMAND\"' ERR\n{line}", number, []))
    elif line.startswith("$ "):
        block.commands.append((line[2:], number, []))
    elif block.commands:
        block.commands[-1][2].append(line)
    else:
        raise ValueError(f"{block.page}:{number}: the block begins with output; put '$ ' and the command before it")


def comparable(line):
    """A line without what depends on the machine."""
    for pattern, substitute in VARYING:
        line = pattern.sub(substitute, line)
    return line.rstrip()


def shows(shown, printed):
    """Whether a command printed what a page shows; a line '...' stands for any lines."""
    lines = (r"(?:.*\n)*" if line == "..." else re.escape(comparable(line)) + r"\n" for line in shown)
    return re.fullmatch("".join(lines), "".join(comparable(line) + "\n" for line in printed)) is not None


def public_logs():
    data = pathlib.Path(os.environ.get("GDTSLAM_DATA", ROOT / ".." / "shared" / "data")) / "slam2d"
    return sorted(data.resolve().glob("*.gz"))


def run(command, folder, environment):
    """Exit code and lines of a command."""
    process = subprocess.run(["bash", "-c", command], cwd=folder, env=environment, stdin=subprocess.DEVNULL,
                             stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, errors="replace", check=False)
    return process.returncode, [line.rstrip() for line in process.stdout.rstrip("\n").split("\n")]


def make_runs(folder, environment):
    """The folder runs/ as tools/run.sh makes it: its commands that simulate and map, in its order."""
    script = (ROOT / "tools" / "run.sh").read_text(encoding="utf-8").split("\n")
    commands = [line for line in script if re.match(r'"\$gdtslam" (simulate|map) ', line)]
    names = [line for line in script if re.match(r"(runs|log|truth|result|floor)=", line)]
    if not commands or not names:
        raise ValueError("tools/run.sh: no command there that simulates or maps, so the pages have no runs/")
    code, lines = run("\n".join(["set -e", "root=.", "gdtslam=gdtslam", *names, "mkdir -p runs", *commands]),
                      folder, environment)
    if code != 0:
        raise ValueError("the commands of tools/run.sh failed:\n" + "\n".join(lines))


class Pages:
    """Runs the blocks of pages and keeps count."""

    def __init__(self, arguments, work):
        self.arguments, self.work, self.logs = arguments, work, public_logs()
        programs = work / "bin"
        programs.mkdir()
        program = arguments.program.resolve()
        (programs / "gdtslam").symlink_to(program)
        (programs / "gdtslam-lab").symlink_to(program.with_name("gdtslam-lab"))
        self.environment = {name: value for name, value in os.environ.items() if name != "GDTSLAM_DATA"}
        self.environment.update(PATH=f"{programs}:{os.environ['PATH']}", LC_ALL="C", XDG_CACHE_HOME=str(work / "cache"))
        self.differences, self.ran, self.left_out = 0, 0, {}

    def folder_for(self, page):
        """A folder with what every page may use; files are shared by links, for the command replaces, never changes, one."""
        ready = self.work / "ready"
        if not ready.is_dir():
            ready.mkdir()
            make_runs(ready, self.environment)
        folder = self.work / str(page).replace("/", "_")
        shutil.copytree(ready, folder, copy_function=os.link)
        os.link(folder / "runs" / "office-loop.log", folder / "my.log")
        for log in self.logs:
            (folder / log.name).symlink_to(log)
        return folder

    def why_not(self, block):
        """Why a block is not run now, or None."""
        if block.mark == "not run":
            return f"not run: {block.reason}"
        if block.mark == "slow" and not self.arguments.all:
            return "slow: run with --all"
        if block.needs_logs() and not self.logs:
            return "no public logs: set GDTSLAM_DATA"
        return None

    def visit(self, page):
        path = ROOT / page
        text = path.read_text(encoding="utf-8")
        lines, changes, start, count, folder = text.split("\n"), [], time.monotonic(), self.ran, None
        for block in blocks_of(page, text):
            reason = self.why_not(block)
            if reason:
                self.left_out.setdefault(reason, []).append(block.where())
                continue
            folder = folder or self.folder_for(page)
            self.ran += 1
            for command, behind, shown in block.commands:
                changes += self.judge(block, command, behind, shown, *run(command, folder, self.environment))
        for behind, count_shown, new in reversed(changes):
            lines[behind:behind + count_shown] = new
        if changes:
            path.write_text("\n".join(lines), encoding="utf-8")
        if folder:
            print(f"{page}: {self.ran - count} blocks, {time.monotonic() - start:.1f} s", flush=True)
            shutil.rmtree(folder)

    def judge(self, block, command, behind, shown, code, printed):
        """Says what differs; the changes to the page where it is to be written."""
        fails = any(line.startswith("gdtslam: error: ") for line in shown)
        if (code != 0) != fails:
            self.complain(block, command, f"exit code {code}", printed)
            return []
        body = list(shown)
        while body and not body[-1].strip():
            body.pop()
        if not body or shows(body, printed):
            return []
        if self.arguments.write and "..." not in body:
            print(f"{block.where()}: written anew: {command}")
            return [(behind, len(body), printed)]
        self.complain(block, command, "the output is not what the page shows", list(difflib.unified_diff(
            [comparable(line) for line in body], [comparable(line) for line in printed], "the page", "the command",
            lineterm="", n=1)))
        return []

    def complain(self, block, command, what, lines):
        self.differences += 1
        print(f"{block.where()}: {what}: {command if block.language == 'console' else 'the script'}")
        print("\n".join(f"    {line}" for line in lines[:60]))

    def report(self):
        for reason, blocks in sorted(self.left_out.items()):
            print(f"left out ({len(blocks)}), {reason}: {', '.join(blocks)}")
        print(f"{self.ran} blocks run, {sum(map(len, self.left_out.values()))} left out, {self.differences} differ")


def arguments_of():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    mode = parser.add_mutually_exclusive_group(required=True)
    mode.add_argument("--check", action="store_true", help="compare")
    mode.add_argument("--write", action="store_true", help="write what is printed into the pages")
    parser.add_argument("--all", action="store_true", help="also the blocks that are marked as slow")
    parser.add_argument("--program", type=pathlib.Path, default=ROOT / "build/release/bin/gdtslam", help="the command")
    parser.add_argument("--share", default="1/1", metavar="K/N", help="of the pages every N-th, from the K-th on")
    parser.add_argument("pages", nargs="*", metavar="PAGE", help="pages, from the root of the clone [all]")
    arguments = parser.parse_args()
    if not re.fullmatch(r"[1-9]\d?/[1-9]\d?", arguments.share):
        parser.error("--share is K/N, say 2/4")
    arguments.first, arguments.step = map(int, arguments.share.split("/"))
    return arguments


def main():
    arguments = arguments_of()
    if not os.access(arguments.program, os.X_OK):
        print(f"doc_outputs: no program at {arguments.program}; build it (tools/run.sh) or name it", file=sys.stderr)
        return 69
    pages = arguments.pages or ["README.md", *sorted(str(path.relative_to(ROOT)) for path in (ROOT / "docs").rglob("*.md"))]
    pages = pages[arguments.first - 1::arguments.step]
    with tempfile.TemporaryDirectory(prefix="gdtslam-docs-") as work:
        visited = Pages(arguments, pathlib.Path(work))
        try:
            for page in pages:
                visited.visit(page)
        except (ValueError, OSError) as problem:
            print(f"doc_outputs: {problem}", file=sys.stderr)
            return 1
        visited.report()
    return 1 if visited.differences else 0


if __name__ == "__main__":
    sys.exit(main())
