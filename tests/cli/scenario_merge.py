"""Runs joined to sites: where they overlap, in any order, and where not."""

import fcntl
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
    shutil.copytree(early, folder / "other/1")
    expect_exit(command("merge", late, early, "-o", folder / "other", "-q"), 2)
    # With --force a run that lay there goes, with what it could be gone on with.
    expect_exit(command("merge", late, early, "-o", folder / "other", "--threads", 2, "-q", "--force"), 0)
    left = sorted(path.name for path in (folder / "other/1").iterdir())
    expect(left == sorted(path.name for path in site.iterdir()), f"{left}")
    for name in SITE_FILES:
        expect((site / name).read_bytes() == (folder / "other/1" / name).read_bytes(), f"{name} depends on the order")
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
    (folder / "site/1").mkdir(parents=True)
    (folder / "site/1/map.yaml").write_text("mine\n")
    process = command("merge", early, late, "-o", folder / "site")
    expect_exit(process, 2)
    expect("map.yaml that no run wrote" in process.stderr, process.stderr)
    expect((folder / "site/1/map.yaml").read_text() == "mine\n", "a foreign file was replaced")
    expect_exit(command("merge", early, late, "-o", folder / "site", "--force", "-q"), 0)


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


def merge_of_cropped_runs():
    """Keyframes that an edit left without a return join nothing and disturb nobody."""
    folder = fresh_folder("merge_cropped")
    early, late, scans, part = parts_of_the_log(folder)
    for run, outside in ((early, "-2,-9,99,99"), (late, "-99,-99,9,99")):
        expect_exit(command("edit", run, "-o", folder / f"{run.name}_cropped", "--crop", outside, "-q"), 0)
    for runs in ((folder / "early_cropped", folder / "late_cropped"), (folder / "early_cropped", late)):
        process = command("merge", *runs, "-o", folder / "site")
        expect_exit(process, 0)
        sites = json.loads((folder / "site/merge.json").read_text())["sites"]
        expect(sum(run["scans"] for site in sites for run in site["runs"]) == 2 * part, f"{sites} of {scans}")


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
    process = command("merge", *runs, "-o", sites, "-q", *arguments, **options)
    expect_exit(process, code)
    one_error_line(process.stderr)
    expect(words in process.stderr, process.stderr)
    changed = {name for name in before.keys() | all_files(sites).keys() if before.get(name) != all_files(sites).get(name)}
    expect(not changed, f"{words}: {sorted(changed)}")


def merge_is_all_or_nothing():
    """Whatever is in the way of one site or of merge.json, no other site is replaced; what was made for nothing goes."""
    folder = fresh_folder("merge_all_or_nothing")
    first, again, other = two_places(folder)
    sites = folder / "sites"
    expect_exit(command("merge", first, other, "-o", sites, "-q"), 0)
    expect(len(json.loads((sites / "merge.json").read_text())["sites"]) == 2, "not two sites")
    # What a killed drive left stays, too, as long as not all is written.
    (sites / "1/.gdtslam-staging-1999999999").mkdir()
    (sites / "1/.gdtslam-staging-1999999999/log-1.copy").write_text("the only copy")
    kept = folder / "kept"
    shutil.copytree(sites, kept)

    def as_before():
        shutil.rmtree(sites)
        shutil.copytree(kept, sites)

    runs = again, other
    (sites / "2/report.json").unlink()
    refused_merge(2, "that no run wrote", runs, sites)
    as_before()
    (sites / "merge.json").unlink()
    (sites / "merge.json").mkdir()
    refused_merge(74, "merge.json", runs, sites)
    refused_merge(74, "merge.json", runs, sites, "--force")
    as_before()
    (sites / "2/map.pgm").unlink()
    (sites / "2/map.pgm").mkdir()
    refused_merge(74, "map.pgm", runs, sites)
    as_before()
    for place in (sites, sites / "2"):
        lock = os.open(place, os.O_RDONLY)
        fcntl.flock(lock, fcntl.LOCK_EX)
        refused_merge(2, "is writing to", runs, sites)
        os.close(lock)
    expect_exit(command("merge", *runs, "-o", sites, "-q"), 0)
    expect_exit(command("merge", *runs, "-o", folder / "fresh", "-q"), 0)
    for name in ("merge.json", "1/trajectory.tum", "2/map.pgm"):
        expect((sites / name).read_bytes() == (folder / "fresh" / name).read_bytes(), name)
    expect(sorted(all_files(sites)) == sorted(all_files(folder / "fresh")), "files of the earlier merge stay")
    if cli.IS_SANITIZED:
        skip("the library that lets calls fail is not preloaded into a sanitized program")
    for on in (False, True):
        process = command("merge", *runs, "-o", folder / "new", "-q", env=cli.failing_calls("write,sync", 1, on=on))
        expect_exit(process, 74)
        expect(not (folder / "new").exists(), "a folder that was made for nothing is still there")
    as_before()
    count = cli.calls_counted("write,sync", "merge", *runs, "-o", folder / "counted", "-q")
    calls = [("write,sync", k) for k in [*range(1, count - 12, max(1, count // 8)), *range(count - 12, count + 1)]]
    renames = cli.calls_counted("rename", "merge", *runs, "-o", folder / "counted", "-q")
    for kind, failing in calls + [("rename", k) for k in range(renames % 8, renames + 1, 8)]:
        process = command("merge", *runs, "-o", sites, "-q", env=cli.failing_calls(kind, failing, on=kind != "rename"))
        expect_exit(process, 74)
        one_error_line(process.stderr)
        expect(all_files(sites) == all_files(kept), f"{kind} {failing} of {count} or {renames}: the sites changed")


def merge_keeps_foreign_files():
    """Files of a merge's names that none wrote: 2, and they are as they were; others stay beside the new ones."""
    folder = fresh_folder("merge_foreign")
    first, again, other = two_places(folder)
    sites = folder / "sites"
    for name in ("merge.json", "1/session-1.tum", "1/changes.png", "2/changes.svg"):
        shutil.rmtree(sites, ignore_errors=True)
        (sites / name).parent.mkdir(parents=True)
        (sites / name).write_text('{"sites": "mine"}\n')
        refused_merge(2, pathlib.Path(name).name, (first, other), sites)
    expect_exit(command("merge", first, other, "-o", sites, "-q", "--force"), 0)
    expect(not (sites / "2/changes.svg").exists(), "a file of a run's name that no run wrote is still there")
    files = sorted(all_files(sites))
    for name in ("keepout.png", "1/keepout.png", "1/session-7.tum"):
        (sites / name).write_text("mine\n")
    expect_exit(command("merge", again, other, "-o", sites, "-q"), 0)
    expect(sorted(all_files(sites)) == sorted([*files, "keepout.png", "1/keepout.png", "1/session-7.tum"]), "others' files")
    # What a merge that was killed left goes, also where it wrote its report just then; what a drive left stays.
    for process, name, is_left in ((1999999998, ".merge.json.1999999998-22.tmp", False), (1999999997, "log-1.copy", True),
                                   (1999999996, ".merge.json.mine.tmp", True)):
        left = sites / f".gdtslam-staging-{process}" / name
        left.parent.mkdir()
        left.write_text("killed\n")
        expect_exit(command("merge", again, other, "-o", sites, "-q"), 0)
        expect(left.parent.exists() == is_left, f"{left} is {'gone' if is_left else 'still there'}")
        shutil.rmtree(left.parent, ignore_errors=True)
    (sites / "1/changes.png").write_text("mine\n")
    refused_merge(2, "changes.png", (first, other), sites)


def merge_replaces_no_run():
    """In the place of a site: a run to be joined, whatever leads there, another run, an edited site, a link, files of somebody:
    2 and one line before any run is read, and nothing is changed. An empty folder and a site of an earlier merge are replaced."""
    folder = fresh_folder("merge_no_run")
    first, again, other = two_places(folder)
    sites = folder / "sites"
    for k, run in enumerate((first, other), 1):
        shutil.copytree(run, sites / str(k))
    runs = sites / "1", sites / "2"
    for force in ((), ("--force",)):
        refused_merge(2, "is a run to be joined", runs, sites, *force)
        refused_merge(2, "is a run to be joined", (first, other), first, *force)
    (folder / "to_first").symlink_to(sites / "1")
    refused_merge(2, "is a run to be joined", (folder / "to_first", other), sites, "--force")
    refused_merge(2, "is a run that no merge wrote", (again, other), sites)
    (sites / "map.yaml").touch()
    refused_merge(2, "is a run that no merge wrote", (folder / "none", other), sites)
    shutil.rmtree(sites)

    def refused_place(words, *arguments):
        refused_merge(2, words, (first, other), sites, *arguments)
        expect(os.listdir(sites) == ["2"], f"{words}: something was made")

    sites.mkdir()
    (sites / "2").symlink_to(again)
    before = all_files(again)
    refused_place("is a link", "--force")
    expect(all_files(again) == before, "what a link leads to was replaced")
    (sites / "2").unlink()
    (sites / "2").write_text("mine")
    refused_place("is no folder", "--force")
    (sites / "2").unlink()
    (sites / "2").mkdir()
    (sites / "2/note.txt").write_text("mine")
    refused_place("holds files")
    (sites / "2/note.txt").unlink()
    expect_exit(command("merge", first, other, "-o", sites, "-q"), 0)
    refused_merge(2, "is a run to be joined", (sites / "1", sites / "2"), sites)
    expect_exit(command("merge", again, other, "-o", sites, "-q"), 0)
    expect_exit(command("edit", sites / "2", "-o", folder / "edited", "--origin", "1,1", "-q"), 0)
    shutil.rmtree(sites / "2")
    shutil.copytree(folder / "edited", sites / "2")
    refused_merge(2, "is a run that no merge wrote", (first, other), sites)
    expect_exit(command("merge", first, other, "-o", sites, "-q", "--force"), 0)


def merge_takes_earlier_sites_away():
    """Sites of an earlier merge with higher numbers go with the others, or stay with them where the merge fails; files of
    somebody else in their folders stay, and runs and folders that are no sites."""
    folder = fresh_folder("merge_earlier_sites")
    first, again, other = two_places(folder)
    sites = folder / "sites"
    expect_exit(command("merge", again, other, "-o", sites, "-q"), 0)
    for k in (3, 7):
        shutil.copytree(sites / "2", sites / str(k))
    (sites / "7/keepout.png").write_text("mine")
    shutil.copytree(other, sites / "8")
    shutil.copytree(sites / "2", sites / "09")
    (sites / "11").symlink_to(sites / "09")
    kept = folder / "kept"
    shutil.copytree(sites, kept, symlinks=True)
    lock = os.open(sites / "3", os.O_RDONLY)
    fcntl.flock(lock, fcntl.LOCK_EX)
    refused_merge(2, "is writing to", (first, again), sites)
    os.close(lock)
    others = {name: data for name, data in all_files(sites).items() if name.startswith(("8/", "09/", "7/keepout"))}
    if not cli.IS_SANITIZED:
        renames = cli.calls_counted("rename", "merge", first, again, "-o", sites, "-q")
        shutil.rmtree(sites)
        shutil.copytree(kept, sites, symlinks=True)
        for failing in range(max(1, renames - 70), renames + 1, 7):
            refused_merge(74, "cannot be", (first, again), sites, env=cli.failing_calls("rename", failing, on=False))
    expect_exit(command("merge", first, again, "-o", sites, "-q"), 0)
    expect({path.name for path in sites.iterdir()} == {"merge.json", "1", "7", "8", "09", "11"}, f"{sorted(sites.iterdir())}")
    left = all_files(sites)
    expect({name: data for name, data in left.items() if name != "merge.json" and not name.startswith("1/")} == others,
           "others' files")


def outputs_without_a_name():
    """An empty name of what is to be written, as of a variable that nobody set: 2 or 74, one line, and nothing is written."""
    folder = fresh_folder("outputs_without_a_name")
    mapped(folder / "run", "--first", 40)
    mapped(folder / "again", "--first", 45)
    (folder / "here").mkdir()
    run, root = folder / "run", sorted(os.listdir("/"))
    for words in (("merge", run, folder / "again"), ("merge", run, folder / "again", "--force"), ("edit", run, "--origin", "1,1"),
                  ("fleet", "plan", LOG), ("convert", LOG), ("convert", LOG, "--format", "carmen"), ("reproduce",), ("render", run),
                  ("simulate", "corridor")):
        if command(words[0], "--help").returncode != 0:  # not in this build
            continue
        process = command(*words, "-o", "", cwd=folder / "here")
        codes = (2,) if words[0] in ("merge", "render") else (2, 74)
        expect(process.returncode in codes, f"{words}: exit {process.returncode}, {process.stderr}")
        one_error_line(process.stderr)
        expect(not list((folder / "here").iterdir()) and sorted(os.listdir("/")) == root, f"{words}: something was written")
    process = command("tiles", "", cwd=folder / "here")
    expect_exit(process, 65)
    one_error_line(process.stderr)
