"""Runs joined to sites: where they overlap, in any order, and where not."""

import json
import os
import pathlib
import shutil

import cli_support as cli
from cli_support import LOG, RUN, SOURCE, TRUTH, command, expect, expect_exit, fresh_folder, mapped, one_error_line, scans_in, skip

SITE_FILES = ("map.pgm", "map.yaml", "gdt.png", "gdt.yaml", "trajectory.tum", "keyframes.bin.gz", "graph.g2o", "covariance.csv",
              "config.yaml", "overview.png", "graph.png", "session-1.tum", "session-2.tum")


def parts_of_the_log(folder):
    """Its first and its last 60 %, mapped each alone."""
    scans = scans_in(RUN)["scans"]
    part = 6 * scans // 10
    mapped(folder / "early", "--first", part)
    mapped(folder / "late", "--skip", scans - part)
    return folder / "early", folder / "late", scans, part


def mean_error_m(run):
    process = command("evaluate", run, "--reference", TRUTH, "--json")
    expect_exit(process, 0)
    return json.loads(process.stdout)["ate"]["translation_m"]["mean"]


def merge_joins_what_overlaps():
    """Two parts of a drive lie as the whole does; the site is a run; the same bytes in either order."""
    folder = fresh_folder("merge")
    early, late, _, part = parts_of_the_log(folder)
    process = command("merge", early, late, "-o", folder / "site", "--json")
    expect_exit(process, 0)
    cli.validate(process.stdout, "merge")
    merged = json.loads(process.stdout)
    expect(process.stdout == (folder / "site/merge.json").read_text(), "another merge.json")
    expect(len(merged["sites"]) == 1 and merged["searches"][0]["is_joined"], process.stdout)
    expect(len(merged["edges"]) == 1, process.stdout)
    expect([run["run"] for run in merged["sites"][0]["runs"]] == [str(early), str(late)], "not in the order of time")
    site = folder / "site/1"
    report = scans_in(site)
    cli.validate((site / "report.json").read_text(), "report")
    expect(report["scans"] == 2 * part and report["drives"] == [part], f"{report['scans']}, {report['drives']}")
    expect(report["keyframes"] == scans_in(early)["keyframes"] + scans_in(late)["keyframes"], f"{report['keyframes']}")
    whole_m, site_m = mean_error_m(RUN), mean_error_m(site)
    expect(site_m <= 1.2 * whole_m + 0.001, f"{site_m} m, in one go {whole_m} m")
    sessions = [(site / f"session-{k}.tum").read_text().splitlines() for k in (1, 2)]
    paths = [[line for line in lines if not line.startswith("#")] for lines in sessions]
    whole = [line for line in (site / "trajectory.tum").read_text().splitlines() if not line.startswith("#")]
    expect(paths[0] + paths[1] == whole, "the sessions are not the trajectory")
    others = {"other": ("--threads", 2)} | ({"on_device": ("--device", "vulkan")} if cli.vulkan_devices() else {})
    for other, arguments in others.items():
        expect_exit(command("merge", late, early, "-o", folder / other, "-q", *arguments), 0)
        left = sorted(path.name for path in (folder / other / "1").iterdir())
        expect(left == sorted(path.name for path in site.iterdir()), f"{left}")
        for name in SITE_FILES:
            expect((site / name).read_bytes() == (folder / other / "1" / name).read_bytes(), f"{name} depends on {other}")
    found = command("localize", site, LOG, "--every", 300, "--json")
    expect_exit(found, 0)
    expect(all(scan["verdict"] != "poor-fit" for scan in json.loads(found.stdout)["scans"]), found.stdout)
    expect_exit(command("doctor", "--after", site), 0)


def merge_leaves_apart_what_does_not_overlap():
    """A drive through another place is a site of its own, with the poses that it had."""
    folder = fresh_folder("merge_apart")
    scans = scans_in(RUN)["scans"]
    mapped(folder / "office", "--first", scans // 2)
    expect_exit(command("simulate", "corridor", "-o", folder / "other.log", "--seed", 3, "--quiet"), 0)
    expect_exit(command("map", folder / "other.log", "-o", folder / "other", "--quiet"), 0)
    process = command("merge", folder / "other", folder / "office", "-o", folder / "sites")
    expect_exit(process, 0)
    merged = json.loads((folder / "sites/merge.json").read_text())
    expect(len(merged["sites"]) == 2 and not merged["searches"][0]["is_joined"] and not merged["edges"], process.stdout)
    for site in merged["sites"]:
        run, = site["runs"]
        here, there = (poses_of(path / "trajectory.tum") for path in (folder / "sites" / site["folder"], pathlib.Path(run["run"])))
        expect(here == there, f"{run['run']} was moved")
    expect(process.stdout.count("1 run,") == 2, process.stdout)


def poses_of(path):
    with open(path, encoding="ascii") as file:
        return [tuple(round(float(word), 6) for word in line.split()) for line in file if not line.startswith("#")]


def merge_refuses_what_it_cannot_join():
    """Each with one line and what to do; nothing is written."""
    folder = fresh_folder("merge_refusals")
    early, late = folder / "early", folder / "late"
    mapped(early, "--first", 200)
    mapped(late, "--skip", 100, "--first", 200)
    mapped(folder / "loose", "--first", 100, "--no-loops")
    expect_exit(command("map", SOURCE / "assets/logs/nodding-start.log.gz", "-o", folder / "nods", "--no-cloud", "-q"), 0)
    shutil.copytree(early, folder / "cut")
    kept = (folder / "cut/keyframes.bin.gz").read_bytes()
    (folder / "cut/keyframes.bin.gz").write_bytes(kept[:len(kept) // 2])
    shutil.copytree(early, folder / "old")
    (folder / "old/keyframes.bin.gz").unlink()
    for runs, code, words in (((early,), 2, "one run has nothing to be joined with"),
                              ((early, early), 65, "is the same run as"),
                              ((early, folder), 65, "is no folder of a run"),
                              ((early, folder / "loose"), 65, "was mapped with --no-loops"),
                              ((early, folder / "nods"), 65, "is a run of a laser that nods"),
                              ((early, folder / "cut"), 65, "keyframes.bin.gz"),
                              ((early, folder / "old"), 65, "keyframes.bin.gz")):
        process = command("merge", *runs, "-o", folder / "site")
        expect_exit(process, code)
        one_error_line(process.stderr)
        expect(words in process.stderr, process.stderr)
        expect(not (folder / "site").exists(), f"{words}: something was written")


def merge_tells_what_counts_twice():
    """A run and its edited copy have every scan in common; parts of a log that do not overlap have none."""
    folder = fresh_folder("merge_twice")
    early, late = folder / "early", folder / "late"
    mapped(early, "--first", 60)
    mapped(late, "--skip", 60, "--first", 60)
    expect_exit(command("edit", early, "--origin", "0,0,20", "-o", folder / "turned", "-q"), 0)
    process = command("merge", early, folder / "turned", late, "-o", folder / "site")
    expect_exit(process, 0)
    shared = json.loads((folder / "site/merge.json").read_text())["shared"]
    expect(len(shared) == 1 and {shared[0]["run"], shared[0]["with"]} == {str(early), str(folder / "turned")}, f"{shared}")
    expect(shared[0]["keyframes"] == scans_in(early)["keyframes"], f"{shared}")
    told = [line for line in process.stdout.splitlines() if "in common" in line]
    expect(len(told) == 1 and f"have {shared[0]['keyframes']} scans in common, which count twice" in told[0], process.stdout)
    process = command("merge", early, late, "-o", folder / "apart", "--json")
    expect_exit(process, 0)
    expect(json.loads(process.stdout)["shared"] == [], process.stdout)


def merge_of_a_site_and_another_run():
    """A site is joined with a third run: its drives stay such in the report, the pictures' captions and an edit. A run that is
    in it already is told of."""
    folder = fresh_folder("merge_of_a_site")
    early, late, scans, part = parts_of_the_log(folder)
    middle = folder / "middle"
    mapped(middle, "--skip", scans // 5, "--first", part)
    for name, runs in (("two", (early, late)), ("three", (folder / "two/1", middle)), ("at_once", (early, late, middle))):
        expect_exit(command("merge", *runs, "-o", folder / name, "-q"), 0)
    once, again = scans_in(folder / "at_once/1"), scans_in(folder / "three/1")
    expect(once["drives"] == again["drives"] == [part, 2 * part], f"{once['drives']}, {again['drives']}")
    expect(abs(once["log_duration_s"] - again["log_duration_s"]) < 1e-3, f"{again['log_duration_s']} s, {once['log_duration_s']} s")
    expect(abs(once["path_m"] - again["path_m"]) < 0.3, f"{again['path_m']} m, {once['path_m']} m")
    expect_exit(command("render", folder / "three/1", "-o", folder / "a.svg", "-q"), 0)
    caption = f"{again['path_m']:.1f} m of path"
    expect(caption in (folder / "a.svg").read_text(), f"{caption!r} is not below the picture")
    expect_exit(command("edit", folder / "three/1", "-o", folder / "edited", "--origin", "0,0,0", "-q"), 0)
    lengths = [len(poses_of(folder / "edited" / f"session-{k}.tum")) for k in (1, 2)]
    expect(lengths == [2 * part, part] and not (folder / "edited/session-3.tum").exists(), f"paths of {lengths} poses")
    process = command("merge", folder / "three/1", middle, "-o", folder / "member")
    expect_exit(process, 0)
    shared, = json.loads((folder / "member/merge.json").read_text())["shared"]
    expect({shared["run"], shared["with"]} == {str(folder / "three/1"), str(middle)}, f"{shared}")
    expect(shared["keyframes"] >= scans_in(middle)["keyframes"], f"{shared}")
    expect(f"have {shared['keyframes']} scans in common, which count twice" in process.stdout, process.stdout)


def two_places(folder):
    """Runs of two places, which are a site each, and another run of the first."""
    mapped(folder / "first", "--first", 60)
    mapped(folder / "again", "--first", 70)
    expect_exit(command("simulate", "corridor", "-o", folder / "other.log", "--seed", 3, "--quiet"), 0)
    expect_exit(command("map", folder / "other.log", "-o", folder / "other", "--first", 60, "--quiet"), 0)
    return folder / "first", folder / "again", folder / "other"


def all_files(folder):
    """Of the folder and those in it."""
    return {str(path.relative_to(folder)): path.read_bytes() for path in sorted(folder.rglob("*")) if path.is_file()}


def refused_merge(code, words, runs, sites, *arguments, **options):
    """It ends so, with one line, and every file is as it was."""
    before = all_files(sites)
    process = command("merge", *runs, "-o", sites, "--force", "-q", *arguments, **options)
    expect_exit(process, code)
    one_error_line(process.stderr)
    expect(words in process.stderr, process.stderr)
    changed = {name for name in before.keys() | all_files(sites).keys() if before.get(name) != all_files(sites).get(name)}
    expect(not changed, f"{words}: {sorted(changed)}")


def merge_is_all_or_nothing():
    """If a write or a rename fails, no site is replaced; what was made for nothing goes. A merge over another one leaves
    nothing of it."""
    folder = fresh_folder("merge_all_or_nothing")
    first, again, other = two_places(folder)
    sites = folder / "sites"
    expect_exit(command("merge", first, other, "-o", sites, "-q"), 0)
    expect(len(json.loads((sites / "merge.json").read_text())["sites"]) == 2, "not two sites")
    runs = first, again
    expect_exit(command("merge", *runs, "-o", folder / "fresh", "-q"), 0)
    if cli.IS_SANITIZED:
        skip("the library that lets calls fail is not preloaded into a sanitized program")
    process = command("merge", *runs, "-o", folder / "new", "-q", env=cli.failing_calls("write,sync", 1, on=True))
    expect_exit(process, 74)
    expect(not (folder / "new").exists(), "a folder that was made for nothing is still there")
    for kind in ("write,sync", "rename"):
        refused_merge(74, "cannot", runs, sites, "--force", env=cli.failing_calls(kind, 1, on=kind == "write,sync"))
    expect_exit(command("merge", *runs, "-o", sites, "-q", "--force"), 0)
    expect(all_files(sites).keys() == all_files(folder / "fresh").keys(), "files of the earlier merge stay")
    for name in ("merge.json", "1/trajectory.tum", "1/map.pgm"):
        expect((sites / name).read_bytes() == (folder / "fresh" / name).read_bytes(), name)


def merge_replaces_only_merges():
    """A folder with a run to be joined, whatever leads there, another run in the place of a site, files of somebody: 2 and one
    line before any run is read, and nothing is changed."""
    folder = fresh_folder("merge_no_run")
    first, again, other = two_places(folder)
    sites = folder / "sites"
    expect_exit(command("merge", first, other, "-o", sites, "-q"), 0)
    (folder / "to_site").symlink_to(sites / "1")
    for runs, place in (((sites / "1", other), sites), ((folder / "to_site", other), sites), ((first, other), first)):
        refused_merge(2, "has a run to be joined", runs, place, "--force")
    (sites / "1/notes.txt").write_text("mine")
    refused_merge(2, "that no run wrote", (again, other), sites, "--force")
    (sites / "1/notes.txt").unlink()
    shutil.rmtree(sites / "2")
    shutil.copytree(again, sites / "2")
    refused_merge(2, "holds a folder 2 that no run wrote", (first, other), sites, "--force")
    shutil.rmtree(sites / "2")
    expect_exit(command("merge", first, other, "-o", sites, "-q", "--force"), 0)


def outputs_without_a_name():
    """An empty name of what is to be written, as of a variable that nobody set: 2 or 74, one line, and nothing is written."""
    folder = fresh_folder("outputs_without_a_name")
    mapped(folder / "run", "--first", 40)
    mapped(folder / "again", "--first", 45)
    (folder / "here").mkdir()
    run, root = folder / "run", sorted(os.listdir("/"))
    for words in (("merge", run, folder / "again"), ("merge", run, folder / "again", "--force"), ("edit", run, "--origin", "1,1"),
                  ("fleet", "run", LOG), ("convert", LOG), ("convert", LOG, "--format", "carmen"), ("render", run),
                  ("simulate", "corridor")):
        if command(words[0], "--help").returncode != 0:  # not in this build
            continue
        process = command(*words, "-o", "", cwd=folder / "here")
        codes = (2,) if words[0] in ("merge", "render") else (2, 74)
        expect(process.returncode in codes, f"{words}: exit {process.returncode}, {process.stderr}")
        one_error_line(process.stderr)
        expect(not list((folder / "here").iterdir()) and sorted(os.listdir("/")) == root, f"{words}: something was written")
