"""The main commands where little is as usual: folders, locales, streams, arguments. Each gives the bytes
that it gives anywhere, or says in one line what is missing."""

import os
import shutil
import subprocess
import sys

import cli_support as cli
from cli_support import LOG, PROGRAM, RUN, environment, expect, expect_exit, one_error_line
from scenario_live_inputs import wait_until
from surroundings import cases_of, check_all, files_of, run

NOWHERE = "/nonexistent"


def surroundings_folders():
    """No folder for temporary files, no home, none that can be written, no working folder, every permission taken away: the
    right bytes. Where the results of `map` would lie in a working folder that is gone: 74."""
    folder = cli.fresh_folder("surroundings_folders")
    cases = cases_of(folder)
    check_all(cases, folder, "without a temporary folder", env=environment(TMPDIR=NOWHERE, TMP=NOWHERE, TEMP=NOWHERE))
    bare = {"PATH": "/usr/bin:/bin"}
    check_all(cases, folder, "without any environment", env=bare)
    for home in ("/proc", "/dev/null", "relative"):
        check_all(cases, folder, f"with the home {home!r}", env={**bare, "HOME": home, "XDG_CACHE_HOME": home, "XDG_RUNTIME_DIR": home,
                                                                 "XDG_CONFIG_HOME": home, "XDG_DATA_HOME": home})
    for zone in ("<\x1b[31m>-99:99", "A" * 5000):
        check_all(cases, folder, f"in the zone {zone[:20]!r}", env=environment(TZ=zone))
    gone = folder / "gone"

    def leave():
        gone.mkdir(exist_ok=True)
        os.chdir(gone)
        gone.rmdir()

    check_all(cases, folder, "in a folder that is gone", preexec_fn=leave)
    process = cli.command("map", LOG, "--first", 20, "-q", preexec_fn=leave)
    expect_exit(process, 74)
    one_error_line(process.stderr)
    if os.geteuid() == 0:  # who is root reads and writes what nobody may
        check_all(cases, folder, "with the umask 0777", preexec_fn=lambda: os.umask(0o777))
    else:
        check_all(cases, folder, "with the umask 0777", (74,), preexec_fn=lambda: os.umask(0o777), must=False)


def namespace():
    """The words that begin a program in a mount namespace of its own; skips where there is none to be had."""
    for words in (["unshare", "-m"], ["unshare", "-r", "-m"]):
        if shutil.which("unshare") and subprocess.run([*words, "true"], capture_output=True, check=False).returncode == 0:
            return words
    return cli.skip("no mount namespace is to be had here (root, or unprivileged user namespaces)")


def surroundings_read_only():
    """Everything but the folder of the results is read-only, /tmp too: the right bytes; a result elsewhere: 74, and one line."""
    begin = namespace()
    folder = cli.fresh_folder("surroundings_read_only")
    cases = cases_of(folder)
    (folder / "out").mkdir(exist_ok=True)
    script = f"""set -e
mount --make-rprivate /
mount --bind "$1" "$1"
shift
awk '$5 != "/proc" && $5 !~ "^/(proc|sys|dev)/" {{print $5}}' /proc/self/mountinfo | while read -r place; do
  case "$place" in {folder}) ;; *) mount -o remount,bind,ro "$place" 2>/dev/null || true ;; esac
done
if touch /tmp/gdtslam-probe 2>/dev/null; then rm -f /tmp/gdtslam-probe; echo "still writable" >&2; exit 99; fi
cd /
exec "$@"
"""
    before = [*begin, "sh", "-c", script, "sh", str(folder)]
    check_all(cases, folder, "on a read-only system", before=before, env=environment(HOME="/root", XDG_CACHE_HOME=None, TMPDIR=None))
    for arguments in (("map", LOG, "--first", 20, "-q"), ("map", LOG, "--first", 20, "-q", "-o", "/gdtslam-run"),
                      ("simulate", "wall", "-q", "-o", "/gdtslam-drive.log"), ("render", RUN, "--view", "map", "-o", "/gdtslam.png")):
        if arguments[0] == "render" and os.environ.get("GDTSLAM_VIEWER") != "1":
            continue
        process = subprocess.run([*before, PROGRAM, *map(str, arguments)], capture_output=True, text=True, check=False, timeout=100 * cli.SLOWNESS)
        expect_exit(process, 74)
        one_error_line(process.stderr)


def surroundings_locales():
    """Decimal commas, a Turkish i, Japanese, a locale that is not there: the same bytes."""
    if not shutil.which("localedef") or not os.path.isdir("/usr/share/i18n/locales"):
        expect(os.environ.get("GDTSLAM_REQUIRE_PROGRAMS") != "1", "GDTSLAM_REQUIRE_PROGRAMS=1, and there is no localedef (package locales)")
        cli.skip("there is no localedef with its sources (package locales)")
    folder = cli.fresh_folder("surroundings_locales")
    cases = cases_of(folder)
    places = folder / "locales"
    places.mkdir()
    for name in ("de_DE", "tr_TR", "ja_JP"):
        subprocess.run(["localedef", "-i", name, "-f", "UTF-8", places / f"{name}.UTF-8"], check=True, capture_output=True)
    probe = "import locale; locale.setlocale(locale.LC_ALL, ''); print(locale.localeconv()['decimal_point'])"
    for name, point in (("de_DE.UTF-8", ","), ("tr_TR.UTF-8", ","), ("ja_JP.UTF-8", "."), ("C", ".")):
        env = environment(LOCPATH=str(places), LC_ALL=name, LANG=name, LANGUAGE=name[:2])
        said = subprocess.run([sys.executable, "-c", probe], env=env, capture_output=True, text=True, check=True).stdout.strip()
        expect(said == point, f"{name} was not made: its decimal point is {said!r}")
        check_all(cases, folder, f"in {name}", env=env)
    check_all(cases, folder, "in a locale that is not there", env=environment(LC_ALL="xx_XX.UTF-8\x1b[31m", LANG="/../.."))


def surroundings_streams():
    """Standard streams that are closed, or take nothing: 74 where something had to be printed, and the files are those of any
    other run; no stream's text lands in a file."""
    folder = cli.fresh_folder("surroundings_streams")
    cases = cases_of(folder)

    def without(*numbers):
        def close():
            for number in numbers:
                os.close(number)
        return close

    def files_are_there(case, out, where):
        expect(files_of(out) == case.expected[0], f"{case.name} {where}: other files: {sorted(set(files_of(out).items()) ^ set(case.expected[0].items()))}")

    for numbers in ((0,), (1,), (2,), (1, 2), (0, 1, 2)):
        where = f"without the streams {numbers}"
        for case in cases:
            process, out = run(case, folder, preexec_fn=without(*numbers), stdin=None)
            prints = case.prints or "-q" not in case.arguments
            wanted = 74 if 1 in numbers and prints else 0
            expect(process.returncode == wanted, f"{case.name} {where}: exit {process.returncode}: {process.stderr}")
            files_are_there(case, out, where)
            if wanted == 74 and 2 not in numbers:
                one_error_line(process.stderr.decode())
                expect("standard output: cannot be written" in process.stderr.decode(), f"{process.stderr}")
    with open("/dev/full", "wb") as full:
        for case in cases:
            process, out = run(case, folder, stdout=full)
            prints = case.prints or "-q" not in case.arguments
            expect(process.returncode == (74 if prints else 0), f"{case.name} to a full device: {process.returncode} {process.stderr}")
            files_are_there(case, out, "to a full device")
            process, out = run(case, folder, stderr=full)
            expect(process.returncode == 0, f"{case.name}, errors to a full device: {process.returncode}")
            files_are_there(case, out, "with errors to a full device")
    for numbers in ((1, 2), (2,)):  # with the input in a pipe the first file that is opened is one of the run's
        process = subprocess.Popen([PROGRAM, "map", "-", "-o", folder / "slow", "--force"], preexec_fn=without(*numbers), stdin=subprocess.PIPE,
                                   **{name: subprocess.DEVNULL for name, number in (("stdout", 1), ("stderr", 2)) if number not in numbers})
        process.stdin.write(LOG.read_bytes()[:200000])
        process.stdin.flush()
        wait_until(lambda: list(folder.glob(".slow.gdtslam-new/*")), "a file of the run")  # noqa: B023, called at once
        for number in numbers:
            link = os.readlink(f"/proc/{process.pid}/fd/{number}")
            expect(link == "/", f"without the streams {numbers} the number {number} is {link}")
        process.stdin.close()
        expect(process.wait(100 * cli.SLOWNESS) == (74 if 1 in numbers else 0), f"exit {process.returncode}")
    process = subprocess.run([PROGRAM, "map", "-", "-o", folder / "none"], preexec_fn=without(0), capture_output=True, text=True,
                             check=False, timeout=100 * cli.SLOWNESS)
    expect_exit(process, 74)
    one_error_line(process.stderr)


def surroundings_arguments():
    """No name of the program, a hundred thousand arguments, words that are no UTF-8, names that would order a terminal about:
    done as ever, or one clean line."""
    folder = cli.fresh_folder("surroundings_arguments")
    for name in ("", "x" * 10000, "\x1b[31m", "a/b\nc"):
        process = subprocess.run([name, "config", "show", "map.resolution"], executable=PROGRAM, capture_output=True, text=True, check=False,
                                 timeout=100 * cli.SLOWNESS)
        expect(process.returncode == 0 and process.stdout.startswith("map.resolution"), f"argv[0] {name[:20]!r}: {process}")
    for arguments, code in ((["map", *["a"] * 100000], 74), (["x"] * 100000, 2), (["config", "show", *["--set"] * 99999], 2),
                            (["map", str(LOG), *["--set", "a=1"] * 50000], 78), (["help", *["map"] * 100000], 2),
                            (["doctor", *["--"] * 100000], 2)):
        process = subprocess.run([PROGRAM, *arguments], capture_output=True, text=True, check=False, timeout=60 * cli.SLOWNESS, cwd=folder)
        expect(process.returncode == code, f"{arguments[:4]}: exit {process.returncode}: {process.stderr[:300]}")
        one_error_line(process.stderr)
        expect(len(process.stderr) < 2000, f"{arguments[:4]}: an error of {len(process.stderr)} letters")
    hostile = b"a\nb\x1b[31mc\"d'e`f$g\xff\xfe h"
    (folder / os.fsdecode(hostile)).symlink_to(LOG)
    for arguments in (["map", hostile, "-o", b"run " + hostile, "--first", "20"], ["doctor", hostile],
                      ["localize", b"run " + hostile, hostile, "--scan", "3"], ["evaluate", b"run " + hostile + b"/trajectory.tum", "--reference", str(cli.TRUTH)],
                      ["map", b"--" + hostile], ["map", hostile + b"none"], [hostile], ["config", "show", hostile], ["simulate", hostile, "-o", "a.log"],
                      ["map", "--continue", hostile]):
        process = subprocess.run([PROGRAM, *arguments], capture_output=True, check=False, timeout=100 * cli.SLOWNESS, cwd=folder, stdin=subprocess.DEVNULL)
        text = process.stdout + process.stderr
        shown = text.decode("utf-8")  # what is no UTF-8 is shown as \\xff
        expect(all(letter.isprintable() or letter == "\n" for letter in shown), f"{arguments}: {text!r}")
        expect(process.returncode in (0, 2, 65, 74, 78), f"{arguments}: exit {process.returncode}: {shown}")
        if process.returncode != 0:
            one_error_line(process.stderr.decode("utf-8"))
    expect((folder / os.fsdecode(b"run " + hostile) / "report.json").exists(), "no run of a log of that name")
