"""gdtslam reproduce from the outside: parts that are made, kept and made again, and a report that needs nothing else."""

import base64
import fcntl
import hashlib
import html.parser
import json
import os
import pathlib
import re
import signal
import subprocess
import threading
import time
import xml.etree.ElementTree as xml

import cli_support as cli
from cli_support import PROGRAM, command, digests, environment, expect, expect_exit, finish, one_error_line

WITHOUT_DATA = environment(GDTSLAM_DATA=None)
CHEAP = ("fig3", "fig11")
VOID = {"meta", "img", "br", "link", "input", "hr"}


def reproduced(folder, *arguments, **options):
    """Runs; what it says as JSON, parts by name."""
    process = command("reproduce", "-o", folder, "--json", *arguments, env=WITHOUT_DATA, timeout=250, **options)
    expect_exit(process, 0)
    cli.validate(process.stdout, "reproduce")
    said = json.loads(process.stdout)
    return {part["part"]: part for part in said["parts"]}, said


def refused(code, *arguments, says, env=WITHOUT_DATA):
    process = command("reproduce", *arguments, env=env)
    expect_exit(process, code)
    one_error_line(process.stderr)
    expect(says in process.stderr, f"{says!r} is not in {process.stderr!r}")


class Page(html.parser.HTMLParser):
    """Tags that close in order, ids, and everything that leads elsewhere."""

    def __init__(self, text):
        super().__init__(convert_charrefs=True)
        self.open, self.ids, self.links, self.pictures, self.words = [], [], [], [], {}
        self.feed(text)
        self.close()
        expect(not self.open, f"never closed: {self.open}")

    def handle_starttag(self, tag, attributes):
        values = dict(attributes)
        if tag not in VOID:
            self.open.append(tag)
        if "id" in values:
            self.ids.append(values["id"])
        for name in ("href", "src", "srcset", "data", "action", "poster", "xlink:href"):
            if name in values:
                (self.pictures if tag in ("img", "image") else self.links).append(values[name])
        if tag == "img":
            expect(values.get("alt"), "a picture without words for who cannot see it")

    def handle_startendtag(self, tag, attributes):
        self.handle_starttag(tag, attributes)
        if tag not in VOID:
            self.open.pop()

    def handle_endtag(self, tag):
        expect(self.open and self.open[-1] == tag, f"</{tag}> closes {self.open[-3:]}")
        self.open.pop()

    def handle_data(self, data):
        if self.open:
            self.words.setdefault(self.open[-1], []).append(data)


def drawings_in(text):
    """Each <svg> of the page with those that it holds itself, which clip what they show."""
    drawings, depth, begin = [], 0, 0
    for tag in re.finditer(r"<svg\b|</svg>", text):
        if tag[0] == "<svg":
            begin = begin if depth else tag.start()
            depth += 1
        else:
            depth -= 1
            if depth == 0:
                drawings.append(text[begin : tag.end()])
    expect(depth == 0, "a drawing that does not end")
    return drawings


def check_page(path):
    """Well formed, nothing from elsewhere, every link within leads somewhere, drawings are XML."""
    text = path.read_text(encoding="utf-8", errors="strict")
    page = Page(text)
    expect(len(page.ids) == len(set(page.ids)), f"ids twice: {page.ids}")
    expect(page.pictures and all(p.startswith("data:image/png;base64,iVBORw0KGgo") for p in page.pictures), "a picture is not in the page")
    for link in page.links:
        expect(link.startswith("#") and link[1:] in page.ids, f"{link} leads out of the page")
    expect("url(" not in text and "@import" not in text, "the style sheet wants something from elsewhere")
    expect(set(re.findall(r"https?://[^\"'\s<]*", text)) <= {"http://www.w3.org/2000/svg", "http://www.w3.org/1999/xlink"},
           "an address of elsewhere")
    drawings = drawings_in(text)
    expect(drawings, "no drawing")
    for drawing in drawings:
        xml.fromstring(drawing)
    expect("{{" not in text, "a mark of the skeleton is left")
    return page


def reproduce_cheap_parts():
    """Figures 3 and 11: numbers that others counted, a page that needs nothing else, Markdown whose pictures are there."""
    folder = cli.fresh_folder("reproduce") / "report"
    parts, said = reproduced(folder, "--only", ",".join(CHEAP))
    expect({name for name, part in parts.items() if part["made"]} == set(CHEAP), f"{parts}")
    ours = [row["ours"] for row in parts["fig3"]["rows"]]
    expect(ours == ["0 of 100", "80 of 100", "88 of 100"], f"{ours}")
    expect([row["verdict"] for row in parts["fig3"]["rows"]] == ["within", "outside", "no verdict"], "verdicts of figure 3")
    ours = [row["ours"] for row in parts["fig11"]["rows"]]  # docs/linkage.md, found with another program
    expect(ours[0] == "12.4 < 13.5 cm" and ours[1].startswith("93.0") and ours[2].startswith("2.85") and ours[3].startswith("9.1"), f"{ours}")

    page = check_page(pathlib.Path(said["html"]))
    expect(set(parts) <= set(page.ids), f"a part has no section: {page.ids}")
    text = pathlib.Path(said["html"]).read_text(encoding="utf-8")
    contents = text[text.index('id="contents"'):text.index("</nav>")]
    expect(all(f'href="#{name}"' in contents for name in [*parts, "verdicts", "times"]), f"the contents: {contents}")
    expect(text.index("</nav>") < text.index("<table") and text.index("</nav>") < text.index("<figure"), "contents come first")
    expect(text.rindex("<figure") < text.index('id="verdicts"'), "the table of all numbers stands before pictures")
    expect(re.search(r'id="verdicts">.*?<details>.*?<table', text, re.S), "the table of all numbers is not folded")
    remarks = [row["remark"] for part in parts.values() for row in part.get("rows") or []]
    expect(remarks and not any(remark.startswith(("within", "outside")) for remark in remarks), f"a remark reads as a verdict: {remarks}")
    commands = "\n".join(page.words["pre"])
    for name in parts:
        expect(re.search(rf"gdtslam reproduce -o report --only {name}\b", commands), f"no command for {name}")
    everything = " ".join(" ".join(words) for words in page.words.values())
    for word in (said["version"], said["processor"], said["device"], "simulated", "Not made yet"):
        expect(word in everything, f"the page does not say {word}")

    markdown = (folder / "report.md").read_text(encoding="utf-8")
    pictures = re.findall(r"!\[[^\]]*\]\(([^)]*)\)", markdown)
    expect(len(pictures) == 7 and all((folder / picture).stat().st_size > 1000 for picture in pictures), f"{pictures}")
    plain = markdown.replace("\\", "")
    for word in (said["version"], said["processor"], said["device"], "Not made yet", "CPU time of each part"):
        expect(word in plain, f"the Markdown does not say {word}")
    for part in parts.values():
        for row in part["rows"]:
            for text in filter(None, row.values()):
                expect(text in everything.replace("\u00a0", " ") and plain.count(text) >= 2, f"page or Markdown lacks {text!r}")

    expect(sorted(p.name for p in folder.iterdir()) == ["parts", "report.html", "report.md"], "something else is left in the folder")


def reproduce_keeps_parts():
    """What is made stays byte for byte; what is forced, incomplete, cut or of other inputs is made again."""
    folder = cli.fresh_folder("reproduce_keeps") / "report"
    only = ("--only", "fig3,fig11")
    reproduced(folder, *only)
    before = digests(folder / "parts")
    parts, _ = reproduced(folder, *only)
    expect(not any(part["new"] for part in parts.values()) and digests(folder / "parts") == before, "a part was made twice")
    parts, _ = reproduced(folder, "--only", "fig3", "--force")
    expect(parts["fig3"]["new"] and not parts["fig11"]["new"] and parts["fig11"]["made"], f"{parts}")

    (folder / "parts/fig3/after.svg").unlink()
    (folder / "parts/fig11/part.json").write_text((folder / "parts/fig11/part.json").read_text()[:200])
    parts, _ = reproduced(folder, *only)
    expect(parts["fig3"]["new"] and parts["fig11"]["new"], "an incomplete part was kept")
    kept = folder / "parts/fig3/part.json"
    for change in ({"key": "0" * 64}, {"version": 99}, {"rows": "none"}, {"origin": 7}, {"pictures": [{"file": "../../report.md", "caption": "", "across": 1}]}):
        kept.write_text(json.dumps({**json.loads(kept.read_text()), **change}))
        parts, _ = reproduced(folder, *only)
        expect(parts["fig3"]["new"], f"a part with {change} was kept")
    check_page(folder / "report.html")


def reproduce_interrupted():
    """SIGINT: exit 130, one line, finished parts are kept and in the report; the next run does not make them again."""
    folder = cli.fresh_folder("reproduce_interrupted") / "report"
    process = subprocess.Popen([PROGRAM, "reproduce", "-q", "-o", str(folder)], stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                               text=True, env=WITHOUT_DATA)
    deadline = time.time() + 100
    while not (folder / "parts/fig3/part.json").exists() and process.poll() is None and time.time() < deadline:
        time.sleep(0.02)
    process.send_signal(signal.SIGINT)
    done = finish(process)
    expect_exit(done, 130)
    one_error_line(done.stderr)
    expect("kept" in done.stderr and done.stdout == "", f"{done.stdout} {done.stderr}")
    expect(not list(folder.glob("parts/*.making")), "half a part is left")
    text = (folder / "report.html").read_text(encoding="utf-8")
    expect("Not made yet" in text and "88 of 100" in text, "the report lacks what is made, or says that all is")
    parts, _ = reproduced(folder, "--only", "fig3,fig11")
    expect(not parts["fig3"]["new"], "figure 3 was made twice")
    expect(parts["fig11"]["made"], "the interrupted report does not go on")


def workers_of(process):
    """Ids of the processes that it started."""
    found = []
    for stat in pathlib.Path("/proc").glob("[0-9]*/stat"):
        try:
            parent = int(stat.read_text().rsplit(")", 1)[1].split()[1])
        except OSError:  # it has ended
            continue
        if parent == process.pid:
            found.append(int(stat.parent.name))
    return found


def started(folder):
    """A run whose workers are there."""
    process = subprocess.Popen([PROGRAM, "reproduce", "-q", "-o", str(folder), "--only", "fig8", "--threads", "2"],
                               stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=WITHOUT_DATA, start_new_session=True)
    deadline = time.time() + 100
    while not (folder / "work/office-loop").exists() and process.poll() is None and time.time() < deadline:
        time.sleep(0.02)
    workers = workers_of(process)
    if not workers:
        process.kill()
    expect(workers, "no process works")
    return process, workers


def reproduce_workers():
    """Ctrl-C reaches the workers, too: none is left. A worker that is killed is one line, exit 1, and the same command goes on."""
    folder = cli.fresh_folder("reproduce_workers") / "report"
    process, workers = started(folder)
    os.killpg(process.pid, signal.SIGINT)
    done = finish(process)
    expect_exit(done, 130)
    one_error_line(done.stderr)
    expect(not any(pathlib.Path(f"/proc/{worker}").exists() for worker in workers), "a worker outlives the command")

    folder = cli.fresh_folder("reproduce_workers") / "report"
    process, workers = started(folder)
    os.kill(workers[0], signal.SIGKILL)
    done = finish(process)
    expect_exit(done, 1)
    one_error_line(done.stderr)
    expect("signal 9" in done.stderr and "goes on" in done.stderr, done.stderr)
    expect(not list(folder.glob("parts/*.making")), "half a part is left")
    reproduced(folder, "--only", "fig3")


def reproduce_leaves_others_alone():
    """Folders that reproduce did not make: never removed, and in the way only where they have a name that it needs."""
    folder = cli.fresh_folder("reproduce_others")
    mine = ("work/film/frame.png", "work/notes.txt", "parts/photo/a.jpg", "parts/list.txt")
    for name in mine:
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text("precious")
    before = digests(folder)
    parts, _ = reproduced(".", "--only", "figA", cwd=folder)  # which needs a simulated drive
    expect(parts["figA"]["new"], "figure A was not made")
    after = digests(folder)
    expect({name: after.get(name) for name in before} == before, f"something of the user's changed: {sorted(after)}")
    expect({name.split("/")[1] for name in after if name.startswith("work/")} == {"film", "notes.txt"}, f"{sorted(after)}")

    (folder / "empty/work").mkdir(parents=True)
    reproduced(folder / "empty", "--only", "fig3")
    expect((folder / "empty/work").is_dir(), "an empty folder of the user's is gone")

    reproduced(folder, "--only", "figA", "--force", "--keep-runs")
    (folder / "work/wall/drawing.svg").write_text("beside the log, in a folder of the program's")
    reproduced(folder, "--only", "fig3")
    expect(not (folder / "work/wall").exists() and (folder / "work/film/frame.png").exists(), "kept runs do not go, or more goes")

    for name, part in (("work/wall", "figA"), ("parts/fig3", "fig3"), ("parts/fig3.making", "fig3"), ("report.md", "fig3")):
        folder = cli.fresh_folder("reproduce_others")
        (folder / name).mkdir(parents=True)
        (folder / name / "precious").write_text("precious")
        before = digests(folder)
        refused(74, "-o", folder, "--only", part, "--force", says=f"{folder / name}: was not made by gdtslam reproduce")
        after = digests(folder)
        expect({key: after.get(key) for key in before} == before and not (folder / "report.html").exists(), f"{sorted(after)}")


def reproduce_keeps_old_until_new():
    """--force: at every moment there is a part of that name; one that cannot be made anew leaves the old one."""
    folder = cli.fresh_folder("reproduce_old") / "report"
    reproduced(folder, "--only", "fig3")
    before = digests(folder / "parts")
    if not cli.IS_SANITIZED:
        for at in ("1", "3"):
            full = cli.full_disk(at, GDTSLAM_DATA=None)
            refused(74, "-o", folder, "--only", "fig3", "--force", says="No space left on device", env=full)
            expect(digests(folder / "parts") == before, "the old part is not what it was")
    missing, looks, stop = [], [0], threading.Event()

    def look():
        while not stop.is_set():
            looks[0] += 1
            if not os.path.exists(folder / "parts/fig3/part.json"):
                missing.append(looks[0])

    watch = threading.Thread(target=look)
    watch.start()
    try:
        for _ in range(8):
            parts, _ = reproduced(folder, "--only", "fig3", "--force")
            expect(parts["fig3"]["new"], "--force made nothing")
    finally:
        stop.set()
        watch.join()
    expect(not missing and looks[0] > 1000, f"no part at {len(missing)} of {looks[0]} looks")
    expect(sorted(p.name for p in (folder / "parts").iterdir()) == ["fig3"], "something is left beside the part")


HOSTILE = '<script>alert(1)</script>"><img src=x onerror=alert(2)>\x1b[31m\n# heading | ![](http://a.b/c.png) `'


def hostile(value):
    """The same with hostile text in place of every text; names of files and what decides whether it is kept stay."""
    if isinstance(value, dict):
        return {key: value[key] if key in ("file", "key", "version") else hostile(value[key]) for key in value}
    if isinstance(value, list):
        return [hostile(entry) for entry in value]
    return HOSTILE if isinstance(value, str) else value


def reproduce_hostile_parts():
    """part.json as others may have changed it: texts stay texts; what cannot be read is 74; what is no part is made again."""
    folder = cli.fresh_folder("reproduce_hostile") / "report"
    reproduced(folder, "--only", "fig3")
    kept = folder / "parts/fig3/part.json"
    kept.write_text(json.dumps(hostile(json.loads(kept.read_text()))))
    parts, said = reproduced(folder, "--only", "fig3")
    expect(not parts["fig3"]["new"] and "alert(1)" in parts["fig3"]["rows"][0]["ours"], "the hostile part was not taken")
    text = pathlib.Path(said["html"]).read_text(encoding="utf-8")
    page = Page(text)
    expect(text.count("alert(1)") >= 15, "the texts are not in the page")
    expect(text.count("<script") == 1 and "alert" not in "".join(page.words["script"]), "a script came in")
    expect(not page.pictures and "\x1b" not in text, "a picture or a control character came in")
    policy = re.search(r"script-src 'sha256-([^']*)'", text).group(1)
    program = re.search(r"<script>(.*?)</script>", text, re.S).group(1)
    expect(policy == base64.b64encode(hashlib.sha256(program.encode()).digest()).decode(), "the page's own script does not run")
    markdown = (folder / "report.md").read_text(encoding="utf-8")
    expect("\x1b" not in markdown and "\n# heading" not in markdown, "text broke out of its line")
    outside = re.sub(r"```.*?```", "", markdown, flags=re.S)
    expect(not re.search(r"(?<!\\)(<script|\]\(http)", outside), "markup came into the Markdown")
    shown = command("reproduce", "-o", folder, "--only", "fig3", env=WITHOUT_DATA)
    expect_exit(shown, 0)
    expect("kept, made <script>" in shown.stdout and "\x1b" not in shown.stdout, shown.stdout)

    for picture in ("a b.svg", "x(y).svg", "<b>.svg"):
        os.link(folder / "parts/fig3/before.svg", folder / "parts/fig3" / picture)
        part = json.loads(kept.read_text())
        part["pictures"][0]["file"] = picture
        kept.write_text(json.dumps(part))
        parts, _ = reproduced(folder, "--only", "fig3")
        expect(parts["fig3"]["new"], f"a picture of the name {picture} was taken")
    for change in ({"cpu_s": -1}, {"cpu_s": 1e300}):
        kept.write_text(json.dumps({**json.loads(kept.read_text()), **change}))
        parts, _ = reproduced(folder, "--only", "fig3")
        expect(parts["fig3"]["new"], f"a part with {change} was kept")
    for big in ("[" * 60_000_000, "[" + "[]," * 20_000_000 + "0]"):
        kept.write_text(big)
        code, error, megabytes, _ = cli.measured("reproduce", "-o", folder, "--only", "fig3", "-q", env=WITHOUT_DATA)
        expect(code == 0 and error == "", error)
        if not cli.IS_SANITIZED:  # a sanitized program needs more
            expect(megabytes < 600, f"{megabytes} MB")  # with its workers; the 60 MB took 4.6 GB
        expect(json.loads(kept.read_text())["version"] == 2, "the part was not made again")
    kept.unlink()
    kept.symlink_to("/proc/self/mem")  # whose first byte is an EIO
    refused(74, "-o", folder, "--only", "fig3", says=f"{kept}: cannot be read")
    kept.unlink()
    kept.mkdir()
    refused(74, "-o", folder, "--only", "fig3", says=f"{kept}: is a folder")


def reproduce_mistakes():
    """Parts that there are not, folders that cannot be, or that another process makes parts in: one line, the exit code, nothing written."""
    folder = cli.fresh_folder("reproduce_mistakes")
    refused(2, "-o", folder / "a", "--only", "fig33", says="fig3")
    refused(2, "-o", folder / "a", "--only", "tabel1", says="table1")
    refused(2, "-o", folder / "a", "--only", "map", says="--list names all")
    refused(2, "--only", "fig3", says="-o DIR")
    (folder / "file").write_text("old")
    refused(74, "-o", folder / "file", "--only", "fig3", says="file")
    refused(74, "-o", "/proc/report", "--only", "fig3", says="/proc/report")
    refused(74, "-o", folder / "a", "--data", folder / "none", "--only", "fig3", says="no such folder")
    refused(74, "-o", folder / "a", "--data", folder, "--only", "fig3", says="intel.clf.gz")
    refused(74, "-o", folder / "a", "--only", "fig3", says="no such folder", env=environment(GDTSLAM_DATA=str(folder / "none")))
    (folder / "held").mkdir()
    fcntl.flock(os.open(folder / "held", os.O_RDONLY), fcntl.LOCK_EX)
    refused(2, "-o", folder / "held", "--only", "fig3", says=f"another process is writing to '{folder / 'held'}'")
    (folder / "held").rmdir()
    expect(sorted(digests(folder)) == ["file"] and (folder / "file").read_text() == "old", f"{sorted(digests(folder))}")
    if not cli.IS_SANITIZED:
        full = cli.full_disk(GDTSLAM_DATA=None)
        refused(74, "-o", folder / "full", "--only", "fig3", says="No space left on device", env=full)
        expect(not list((folder / "full").glob("parts/*")), "something is left of a part that could not be written")
    process = command("reproduce", "--list", "--json", env=WITHOUT_DATA)
    expect_exit(process, 0)
    names = [name for part in json.loads(process.stdout) for name in (part["part"], part["also"]) if name]
    expect(names == ["fig3", "fig4", "fig7", "fig8", "table1", "fig9", "table2", "fig11", "fig12", "fig13", "fig14", "fig15", "figA"],
           f"{names}")
    process = command("reproduce", "--list", env=WITHOUT_DATA)
    expect_exit(process, 0)
    expect(all(re.search(rf"\b{name}\b", process.stdout) for name in names), process.stdout)
