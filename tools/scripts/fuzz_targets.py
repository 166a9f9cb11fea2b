"""Runs the targets of the fuzz program, and prints a table of what each executed and reached: for tools/scripts/fuzz.sh,
which builds the program first.

Without GDTSLAM_FUZZ_RUNS each target runs for GDTSLAM_FUZZ_S seconds. With it, as many executions are shared out among all
of them: each has its seconds first, then those go on in turn that execute at least half as many a second as the fastest.
What was executed is kept beside the inputs that were found, so that what was stopped goes on where it was; a copy of the
program is run, so that building goes on meanwhile. More than 512 MB or 10 s for an input is a finding like a crash, and ends
with exit status 1."""

import argparse
import fcntl
import json
import os
import pathlib
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time

# Of libFuzzer: its bounds, no names of functions (each asks the symbolizer), no second look at folders that only it writes.
MOST_S = 10
LIMITS = (f"-timeout={MOST_S}", "-rss_limit_mb=512", "-malloc_limit_mb=256", "-print_final_stats=1", "-print_funcs=0", "-reload=0")
TURN_S = 120  # of one of those that go on
MOST_KEPT_BYTES = 1 << 16  # of a target's corpus, what people wrote aside
MADE_BY_FUZZER = re.compile("[0-9a-f]{40}")
COLUMNS = ("executions", "edges", "features", "inputs", "seconds")


class Figures(dict):
    """Of a target: executions and seconds so far; edges, features and inputs as they are at last."""

    def __init__(self, kept=()):
        super().__init__({name: 0 for name in COLUMNS})
        self.update(kept)

    def add(self, log, seconds):
        executed = re.findall(r"^stat::number_of_executed_units: *(\d+)", log, re.MULTILINE)
        if not executed:  # it ended at a finding: as far as it had said
            executed = re.findall(r"^#(\d+)\t", log, re.MULTILINE)
        self["executions"] += int(executed[-1]) if executed else 0
        done_in = re.findall(r"^Done \d+ runs in (\d+) second", log, re.MULTILINE)
        self["seconds"] = round(self["seconds"] + (int(done_in[-1]) if done_in else seconds), 1)
        reached = re.findall(r"^#\d+\t.*cov: (\d+) ft: (\d+) corp: (\d+)/", log, re.MULTILINE)
        if reached:
            self["edges"], self["features"], self["inputs"] = map(int, reached[-1])

    def per_second(self):
        return self["executions"] / max(self["seconds"], 0.1)


class Fuzzing:
    """The program, its corpora, and a folder for what is found."""

    def __init__(self, program, corpus, folder):
        self.program, self.corpus, self.folder = program, corpus, folder
        self.lock = threading.Lock()
        self.figures = {}
        self.running = {}  # targets, and their processes where they have begun
        self.failed = set()
        self.is_over = False

    def all_targets(self):
        listed = subprocess.run([self.program, "targets"], stdout=subprocess.PIPE, text=True, check=True).stdout.split()
        strange = sorted(folder.name for folder in self.corpus.iterdir() if folder.name not in listed)
        if strange:
            sys.exit(f"{self.corpus / strange[0]} is the corpus of no target")
        return listed

    def stop(self, *_):
        """Each process tells what it executed before it goes."""
        self.is_over = True
        for process in filter(None, list(self.running.values())):
            process.send_signal(signal.SIGINT)

    def execute(self, target, options, folders):
        """Runs the program; its exit status and what it printed. Files of the readers lie in memory where there is some."""
        (self.folder / target).mkdir(parents=True, exist_ok=True)
        log = self.folder / target / "log"
        memory = "/dev/shm" if os.access("/dev/shm", os.W_OK) else None
        with tempfile.TemporaryDirectory(prefix="gdtslam-fuzz-", dir=memory) as scratch, open(log, "wb") as output:
            command = [self.program, target, *options, *LIMITS, f"-artifact_prefix={self.folder / target}/", *folders]
            process = subprocess.Popen(command, stdout=output, stderr=subprocess.STDOUT, env={**os.environ, "TMPDIR": scratch},
                                       start_new_session=True)  # an interrupt from the keyboard comes by stop() alone
            self.running[target] = process
            if self.is_over:
                process.send_signal(signal.SIGINT)
            status = process.wait()
        return status, log.read_text(errors="replace")

    def was_kept_waiting(self, target, log):
        """Whether an input took its 10 s only because the machine gave the program no processor: alone it takes less of one."""
        written = re.findall(r"^artifact_prefix=.*Test unit written to (\S+/timeout-\w+)$", log, re.MULTILINE)
        if not written:
            return False
        process = subprocess.Popen([self.program, target, "-timeout=600", written[-1]], stdout=subprocess.DEVNULL,
                                   stderr=subprocess.DEVNULL, start_new_session=True)
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = status
        took_s = usage.ru_utime + usage.ru_stime
        if status != 0 or took_s >= MOST_S:
            return False
        print(f"{target}: an input had to wait for a processor; alone it takes {took_s:.1f} s", file=sys.stderr, flush=True)
        os.remove(written[-1])
        return True

    def run(self, target, options, folders):
        begin = time.monotonic()
        status, log = self.execute(target, options, folders)
        took_s = time.monotonic() - begin
        is_found = status != 0 and not self.is_over and not self.was_kept_waiting(target, log)
        with self.lock:
            del self.running[target]
            self.figures.setdefault(target, Figures()).add(log, took_s)
            if is_found:
                self.failed.add(target)
                print("\n".join(log.splitlines()[-40:]), file=sys.stderr)
                print(f"{target}: FAILED; run it again by {self.program} {target} FILE with the file that is named above",
                      file=sys.stderr, flush=True)

    def found(self, target):
        folder = self.folder / target / "found"
        folder.mkdir(parents=True, exist_ok=True)
        return folder

    def work(self, next_turn, jobs):
        """Runs what `next_turn` says, several at a time, until it says nothing."""

        def worker():
            while True:
                with self.lock:
                    turn = None if self.is_over else next_turn()
                    if turn is None:
                        return
                    self.running[turn[0]] = None
                self.run(*turn)

        workers = [threading.Thread(target=worker) for _ in range(jobs)]
        for thread in workers:
            thread.start()
        for thread in workers:
            while thread.is_alive():
                thread.join(1)  # with a limit, so that signals are heard


class Shared(Fuzzing):
    """So many executions of all targets together, in as many calls as it takes."""

    def __init__(self, program, corpus, folder, targets, runs, seconds):
        folder.mkdir(parents=True, exist_ok=True)
        copy = folder / "program.new"
        shutil.copy(program, copy)
        super().__init__(copy.rename(folder / program.name), corpus, folder)
        self.targets, self.runs, self.seconds = targets, runs, seconds
        self.kept_file = folder / "executed.json"
        kept = json.loads(self.kept_file.read_text()) if self.kept_file.exists() else {}
        self.figures = {name: Figures(kept.get(name, ())) for name in targets}
        self.others = {name: of for name, of in kept.items() if name not in targets}

    def keep(self):
        new = self.kept_file.with_suffix(".new")
        new.write_text(json.dumps({**self.others, **self.figures}, indent=1) + "\n")
        new.replace(self.kept_file)

    def run(self, target, options, folders):
        super().run(target, options, folders)
        with self.lock:
            self.keep()

    def next_turn(self):
        left = self.runs - sum(of["executions"] for of in self.figures.values())
        idle = {name: of for name, of in self.figures.items() if name not in self.running and name not in self.failed}
        if left <= 0 or not idle:
            return None
        new = [name for name, of in idle.items() if of["seconds"] < self.seconds]
        fastest = max(of.per_second() for of in idle.values())
        fast = [name for name, of in idle.items() if of.per_second() >= fastest / 2]
        name = new[0] if new else min(fast, key=lambda name: idle[name]["executions"])
        seconds = self.seconds - idle[name]["seconds"] if new else TURN_S
        return name, (f"-max_total_time={max(1, round(seconds))}", f"-runs={left}"), [self.found(name), self.corpus / name]


def each_once(fuzzing, targets, jobs, option, *, with_found):
    rest = iter(targets)

    def next_turn():
        name = next(rest, None)
        return name and (name, (option,), [*([fuzzing.found(name)] if with_found else []), fuzzing.corpus / name])

    fuzzing.work(next_turn, jobs)


def minimise(fuzzing, target, found):
    """What people wrote stays in the corpus; of all else a few inputs that reach together every edge, up to a number of bytes."""
    corpus = fuzzing.corpus / target
    with tempfile.TemporaryDirectory() as name:
        merged = pathlib.Path(name) / "merged"
        merged.mkdir()
        for file in corpus.iterdir():
            if not MADE_BY_FUZZER.fullmatch(file.name):
                shutil.copy(file, merged)
        written = {file.name for file in merged.iterdir()}
        status, log = fuzzing.execute(target, ("-set_cover_merge=1", "-use_counters=0"), [merged, corpus, *filter(pathlib.Path.is_dir, found)])
        if status != 0:
            sys.exit(f"{target}: cannot be merged:\n{log}")
        made = sorted((file for file in merged.iterdir() if file.name not in written), key=lambda file: (file.stat().st_size, file.name))
        for file in corpus.iterdir():
            if file.name not in written:
                file.unlink()
        left = MOST_KEPT_BYTES
        for file in made:
            left -= file.stat().st_size
            if left < 0:
                break
            shutil.copy(file, corpus)
    files = list(corpus.iterdir())
    print(f"| {target} | {len(files)} | {sum(file.stat().st_size for file in files):,} |", flush=True)


def print_table(figures, targets):
    print("| target | executions | a second | edges | features | inputs | seconds |\n|---|---:|---:|---:|---:|---:|---:|")
    total = Figures()
    for name in targets:
        if name not in figures:
            continue
        of = figures[name]
        for column in COLUMNS:
            total[column] += of[column]
        print(f"| {name} | {of['executions']:,} | {of.per_second():,.0f} | {of['edges']:,} | {of['features']:,} | {of['inputs']:,} "
              f"| {of['seconds']:,.0f} |")
    print(f"| {len(figures)} targets | {total['executions']:,} | {total.per_second():,.0f} | | | {total['inputs']:,} "
          f"| {total['seconds']:,.0f} |", flush=True)


def only_one(folder):
    """Holds the folder against a second call of the same kind."""
    folder.mkdir(parents=True, exist_ok=True)
    held = open(folder / "lock", "w")  # noqa: SIM115, as long as this process lives
    try:
        fcntl.flock(held, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        sys.exit(f"another call fuzzes in {folder}")
    return held


def main():
    parser = argparse.ArgumentParser(prog="fuzz.sh", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("targets", nargs="*", metavar="TARGET", help="only these (default: all)")
    parser.add_argument("-j", type=int, default=os.cpu_count(), metavar="N", dest="jobs", help="so many at a time (default: one a processor)")
    kind = parser.add_mutually_exclusive_group()
    kind.add_argument("--replay", action="store_true", help="run each input of the corpora once")
    kind.add_argument("--minimise", action="store_true", help="put what was found into the corpora, as few inputs as reach every edge")
    parser.add_argument("--program", type=pathlib.Path, required=True, help=argparse.SUPPRESS)
    parser.add_argument("--corpus", type=pathlib.Path, required=True, help=argparse.SUPPRESS)
    parser.add_argument("--folder", type=pathlib.Path, required=True, help=argparse.SUPPRESS)
    chosen = parser.parse_args()
    seconds = int(os.environ.get("GDTSLAM_FUZZ_S") or 15)
    runs = int(os.environ.get("GDTSLAM_FUZZ_RUNS") or 0)
    short, long = chosen.folder / "runs", chosen.folder / "long"
    held = only_one(long if runs and not chosen.minimise and not chosen.replay else short)
    fuzzing = Fuzzing(chosen.program, chosen.corpus, short)
    listed = fuzzing.all_targets()
    unknown = [name for name in chosen.targets if name not in listed]
    if unknown:
        parser.error(f"no target is called {unknown[0]}")
    targets = chosen.targets or listed
    if runs and not chosen.minimise and not chosen.replay:
        fuzzing = Shared(chosen.program, chosen.corpus, long, targets, runs, seconds)
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, fuzzing.stop)
    if chosen.minimise:
        print("| target | inputs | bytes |\n|---|---:|---:|")
        for name in targets:
            minimise(fuzzing, name, [long / name / "found", short / name / "found"])
        return 0
    if chosen.replay:
        each_once(fuzzing, targets, chosen.jobs, "-runs=0", with_found=False)
    elif runs:
        fuzzing.work(fuzzing.next_turn, chosen.jobs)
    else:
        each_once(fuzzing, targets, chosen.jobs, f"-max_total_time={seconds}", with_found=True)
    print_table(fuzzing.figures, targets)
    if fuzzing.is_over:
        print("stopped; the same call goes on" if runs else "stopped", file=sys.stderr)
    held.close()
    return 1 if fuzzing.failed or fuzzing.is_over else 0


if __name__ == "__main__":
    sys.exit(main())
