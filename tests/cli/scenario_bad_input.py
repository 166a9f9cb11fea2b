"""Damaged logs and scarce memory: one stated outcome each."""

import json
import re
import resource
import shutil
import subprocess

import cli_support as cli
from cli_support import DATA, LOG, PROGRAM, RUN, SLOWNESS, command, expect, expect_exit, fresh_folder, one_error_line, skip


def out_of_memory():
    """Wherever an allocation fails: an error (exit 1, one line), no abort, no folder left."""
    if cli.IS_SANITIZED:
        skip("a sanitized program needs all the address space")
    folder = cli.fresh_folder("memory") / "run"

    def limited(megabytes, *arguments):
        limit = megabytes << 20
        return command(*arguments, preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, (limit, limit)))

    megabytes = 8
    while limited(megabytes, "--version").returncode != 0:  # the loader needs room for the libraries
        megabytes += 2
        expect(megabytes < 1024, "the command does not even start")
    failures = set()
    while (process := limited(megabytes, "map", LOG, "-o", folder, "--force", "-q", "--first", 50)).returncode != 0:
        expect_exit(process, 1)
        error = cli.without_thread_remark(process.stderr)
        one_error_line(error)
        expect(re.search("(out of|insufficient) memory", error), process.stderr)
        expect(not folder.exists(), "a folder was left")
        failures.add(error)
        megabytes += 1
        expect(megabytes < 1024, "the command does not run in 1 GB")
    print(f"runs in {megabytes} MB of address space; before: {sorted(failures)}")
    expect(failures, "no allocation failed")


def hostile_log(name, text, code, pattern, *arguments):
    """One log and its one outcome, within a second and 256 MB."""
    folder = cli.fresh_folder(f"hostile/{name}")
    (folder / "drive.log").write_bytes(text)
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    process = command("map", folder / "drive.log", "-o", folder / "run", *arguments)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    cpu_s = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    print(f"{name}: exit {process.returncode}, {cpu_s:.2f} s CPU, at most {after.ru_maxrss // 1024} MB")
    expect_exit(process, code)
    expect(re.search(pattern, process.stdout + process.stderr), f"{name}: {process.stdout}{process.stderr}")
    if code != 0:
        one_error_line(process.stderr)
        expect(not (folder / "run").exists(), f"{name}: a folder was left")
    expect(cpu_s < 1.0, f"{name}: took {cpu_s:.2f} s of CPU")
    expect(after.ru_maxrss < 256 * 1024, f"{name}: took {after.ru_maxrss // 1024} MB")


def hostile_logs():
    """Damaged and malicious logs: one stated outcome each."""
    process = command("map", LOG, "--matcher", "")
    expect_exit(process, 2)
    one_error_line(process.stderr)
    expect("--matcher: names no matcher" in process.stderr, process.stderr)
    if cli.IS_SANITIZED:
        skip("a sanitized program needs more time and memory")
    drive = "".join(cli.room_scan(1 + 0.05 * k, 1.5, 0.01 * k, 10 + 0.2 * k) for k in range(20))
    good = drive.encode()
    scan = cli.room_scan(1.5, 1.5, 0.0, 20.0)
    hostile_log("empty", b"", 65, "is empty")
    hostile_log("binary", bytes(range(256)) * 500, 65, "binary data")
    hostile_log("cut_gzip", b"\x1f\x8b\x08\x00\x00\x00", 65, "gzip")
    hostile_log("long_line", good + b"FLASER 180 " + b"1.0 " * (2 << 20) + b"\n", 65, "drive.log:21: .*longer than")
    hostile_log("long_line_lenient", good + b"FLASER 180 " + b"1.0 " * (2 << 20) + b"\n", 0, "malformed line", "--lenient")
    hostile_log("billion_beams", good + b"FLASER 1000000000 1.0 2.0\n", 65, "drive.log:21: ")
    words = scan.split()
    for name, word in (("nan", "nan"), ("huge", "1e300")):
        changed = " ".join([*words[:50], word, *words[51:]]) + "\n"
        hostile_log(f"range_{name}", good + changed.encode(), 0, "21 scans")
        changed = " ".join([*words[:182], *[word] * 6, *words[188:]]) + "\n"
        hostile_log(f"pose_{name}", good + changed.encode(), *((0, "21 scans|warning") if name == "huge" else (65, "drive.log:21: ")))
        changed = " ".join([*words[:188], word, *words[189:]]) + "\n"
        hostile_log(f"stamp_{name}", good + changed.encode(), *((0, "21 scans") if name == "huge" else (65, "drive.log:21: ")))
    hostile_log("repeated_stamps", scan.encode() * 20, 0, "repeated stamp")
    hostile_log("backward_stamps", "".join(reversed(drive.splitlines(keepends=True))).encode(), 0, "backward stamp")
    fewer = cli.flaser(cli.room_ranges(1.5, 1.5, 0.0, beams=90), (1.5, 1.5, 0), (1.5, 1.5, 0), 30.0)
    hostile_log("beams_change", good + fewer.encode() + scan.encode(), 0, "beam count changed")
    hostile_log("no_beams", good + cli.flaser([], (1, 1, 0), (1, 1, 0), 30.0).encode(), 0, "scan without beams")
    far = cli.flaser(cli.room_ranges(1.5, 1.5, 0.0), (1e7, 0, 0), (1e7, 0, 0), 30.0)
    hostile_log("far_jump", good + far.encode() * 3, 0, "23 scans")
    silent = "".join(cli.flaser([float("inf"), float("nan"), -1.0] * 60, (k, 0, 0), (k, 0, 0), 1.0 + k) for k in range(5))
    hostile_log("all_no_return", silent.encode(), 65, r"drive.log: none of the 5 scans has 20 returns \(scan.min_points\)")
    step = len(good) // 16
    for size in range(step, len(good), step):
        scans = good[:size].count(b"\n")
        tail = good[:size].rsplit(b"\n", 1)[-1].split()
        scans += len(tail) == len(words)  # only the end of the last word is missing, which is not used
        said = f"^{scans} scan{'s' if scans > 1 else ''}, "
        hostile_log("cut", good[:size], 0 if scans else 65, said if scans else "no complete CARMEN message")


def hostile_report():
    """report.json of brackets without end, or of values without number: 65 with its name, and little memory."""
    if cli.IS_SANITIZED:
        skip("a sanitized program needs more time and memory")
    run = cli.fresh_folder("hostile_report") / "run"
    shutil.copytree(cli.RUN, run)
    sound = json.loads((run / "report.json").read_text())
    wide = {**sound, "keyframe_scans": []}
    cases = {
        "is nested deeper than": "[" * 60_000_000,
        "holds more than": json.dumps(wide).replace('"keyframe_scans": []', '"keyframe_scans": [' + "{}," * 20_000_000 + "0]"),
        "is longer than": json.dumps({**sound, "version": "x" * 100_000_000}),
        "is no JSON text": json.dumps(sound)[:-1],
    }
    for fault, text in cases.items():
        (run / "report.json").write_text(text)
        code, error, megabytes, _ = cli.measured("localize", run, LOG)
        print(f"{fault}: exit {code}, {megabytes} MB")
        expect(code == 65, f"exit {code}: {error}")
        one_error_line(error)
        expect(f"{run}/report.json" in error and fault in error and "map the log again: gdtslam map LOG -o" in error, error)
        expect(megabytes < 320, f"{fault}: {megabytes} MB")
    (run / "report.json").write_text(json.dumps({**sound, "doubtful_scans": [{"index": 0}] * 1_000_000}))  # a long day
    code, error, megabytes, _ = cli.measured("localize", run, LOG, "--scan", 1)
    expect(code == 0, error)


def verify_tells_what_it_found_before_an_error():
    """A log without scans ends it with its exit code, after the report of those before it; one that is not there is told first."""
    folder = cli.fresh_folder("before_an_error")
    (folder / "empty.log").write_text("PARAM robot_front_laser_max 81.9\n")
    process = command("verify", "logs", "--device", "cpu", "--isa", "baseline", "--log", folder / "empty.log")
    expect_exit(process, 65)
    one_error_line(process.stderr)
    expect("empty.log: holds no laser scan" in process.stderr, process.stderr)
    expect("office-start.log.gz, " in process.stdout and ": equal, and as shipped" in process.stdout, process.stdout)
    expect("ENDED: " in process.stdout and "empty.log" in process.stdout, process.stdout)
    last = process.stdout.splitlines()[-1]
    expect(last == "FAIL: cpu, 3 threads was not verified to its end; 0 differences until then", last)
    process = command("verify", "logs", "--device", "cpu", "--isa", "baseline", "--log", folder / "empty.log", "--json")
    expect_exit(process, 65)
    cli.validate(process.stdout, "verify")
    report = json.loads(process.stdout)
    expect(report["passed"] is False and "holds no laser scan" in report["targets"][0]["failure"], process.stdout)
    expect(len(report["targets"][0]["logs"]) == 4, process.stdout)
    process = command("verify", "--device", "cpu", "--log", folder / "none.log")
    expect_exit(process, 74)
    one_error_line(process.stderr)
    expect(process.stdout == "", process.stdout)


# Words that are no number, no text, no file and no end.
WORDS = (b"\xff", b"name=\xff", b"", b"nan", b"inf m", b"1e999", b"-1", b"0", b"99999999999999999999", b"a" * 5000, b"%n%s{}{0}",
         b"x\ny", b"/dev/null", b"/dev/null/x", b".", b"\xc3(:=,", b"=", b",", b"1,2,3", b"\x1b[2J", b"../../..", b"map.resolution=")
WORDS_OF_COMMANDS = (f"map {LOG} -o out --no-pictures --first 5", f"edit {RUN} -o out --origin 1,1,90", f"render {RUN} -o out.png --size 64x48", f"localize {RUN} {LOG} --scan 0", f"doctor {LOG}",
                     f"convert {LOG} -o out.csv", f"evaluate {DATA}/few.ply --planes", f"evaluate {RUN} --reference {RUN}",
                     "linkage paper-b", "simulate three-boxes -o out.log --rate 1", "verify seed_scatter --device cpu", "config show")


def hostile_words():
    """Each option that takes a value gets one of the words in turn, and each call ends in time, with a stated exit code and
    with one error line that was meant where that is not 0."""
    calls = 0
    for line in WORDS_OF_COMMANDS:
        name, *words = line.split()
        listed = re.findall(r"^  (?:-\w, )?(--[a-z0-9-]+) [^ \n]", command(name, *words, "--help").stdout, re.MULTILINE)
        for option in listed:
            word = WORDS[calls % len(WORDS)]
            calls += 1
            process = subprocess.run([PROGRAM, name, *words, option, word], cwd=fresh_folder("hostile_words"), capture_output=True,
                                     stdin=subprocess.DEVNULL, timeout=60 * SLOWNESS, check=False)
            errors = [text for text in process.stderr.decode(errors="replace").splitlines() if text.startswith("gdtslam: error:")]
            expect(process.returncode in (0, 1, 2, 65, 69, 70, 74, 78), f"{name} {option} {word}: exit {process.returncode}")
            expect(len(errors) == (process.returncode != 0), f"{name} {option} {word}: exit {process.returncode}, {errors}")
            expect(not any("error: unexpected: " in text for text in errors), f"{name} {option} {word}: {errors}")
    expect(calls > 120, f"{calls} options that take a value")
