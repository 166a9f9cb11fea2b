#!/usr/bin/env python3
"""The library of failing calls (tests/cli/failing_calls.c) under a program whose calls are known: failing_calls_test.py LIBRARY.
And what tools/scripts/fail_each_call.py makes of files that are not what they should be."""

import collections
import json
import os
import pathlib
import shutil
import signal
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.dont_write_bytecode = True
sys.path.insert(0, str(ROOT / "tools/scripts"))
import file_states  # noqa: E402
from fail_each_call import KINDS, LEFTOVER, STATE  # noqa: E402

# Prints each call with what it returned; its argument is the folder, and one beside it is not watched.
PROGRAM = r"""
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>
#define TELL(name, call) do { errno = 0; const long result = (long)(call); printf("%s %ld %d\n", name, result, errno); \
  fflush(stdout); } while (0)
int main(int count, char** arguments) {
  char bytes[16] = {0};
  if (count < 2 || chdir(arguments[1]) != 0) return 9;
  int outside = open("../outside", O_CREAT | O_WRONLY, 0644);
  if (write(outside, "x", 1) != 1 || close(outside) != 0) return 8;
  int file = -1;
  TELL("open", (file = open("a", O_CREAT | O_RDWR, 0644)) >= 0);
  if (file < 0) file = open("a", O_CREAT | O_RDWR, 0644);
  TELL("write", write(file, "0123456789", 10));
  TELL("pread", pread(file, bytes, 10, 0));
  TELL("fsync", fsync(file));
  TELL("ftruncate", ftruncate(file, 4));
  TELL("close", close(file));
  TELL("rename", rename("a", "b"));
  TELL("mkdir", mkdir("c", 0755));
  TELL("symlink", symlink("b", "d"));
  TELL("unlink", unlink("d"));
  void* volatile memory = NULL;
  TELL("malloc", (memory = malloc(100)) != NULL);
  free(memory);
  for (int times = 0; times < 3; ++times) {
    memory = malloc(50);
    free(memory);
  }
  const pid_t child = fork();
  if (child == 0) _exit(mkdir("e", 0755) == 0 ? 0 : 7);
  int status = 0;
  waitpid(child, &status, 0);
  TELL("child", WEXITSTATUS(status));
  return 0;
}
"""


class FailingCallsTest(unittest.TestCase):
    library = None

    @classmethod
    def setUpClass(cls):
        cls.folder = pathlib.Path(tempfile.mkdtemp(prefix="failing-calls-")).resolve()
        (cls.folder / "calls.c").write_text(PROGRAM)
        for name in ("gdtslam-calls", "other-calls"):
            subprocess.run([os.environ.get("CC", "cc"), "-O0", "-o", cls.folder / name, cls.folder / "calls.c"], check=True)

    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(cls.folder)

    def run_with(self, kinds="", at=0, how="", on="0", program="gdtslam-calls", places=None):
        """What the calls returned, by name: result and errno; counts by kind; how it ended."""
        work, state = self.folder / "work", self.folder / "state"
        shutil.rmtree(work, ignore_errors=True)
        work.mkdir()
        state.write_bytes(bytes(STATE.size))
        variables = {**os.environ, "LD_PRELOAD": self.library, "FAILING_KINDS": kinds, "FAILING_AT": str(at), "FAILING_HOW": how,
                     "FAILING_ON": on, "FAILING_BELOW": str(work), "FAILING_STATE": str(state)}
        if places:
            variables.update(FAILING_PLACES=str(places), FAILING_CALLERS="1")
        process = subprocess.run([self.folder / program, work], env=variables, capture_output=True, text=True, check=False)
        returned = {name: (int(result), int(code)) for name, result, code in map(str.split, process.stdout.splitlines())}
        *counts, where = STATE.unpack(state.read_bytes())
        return returned, dict(zip(KINDS, counts)), process.returncode, where.rstrip(b"\0").decode()

    def test_counts_are_those_of_the_program(self):
        _, counts, code, _ = self.run_with()
        self.assertEqual(code, 0)
        expected = {"open": 1, "read": 1, "write": 1, "sync": 1, "close": 1, "rename": 1, "unlink": 1, "mkdir": 2, "link": 1,
                    "truncate": 1, "map": 0, "change": 8}
        self.assertEqual({kind: counts[kind] for kind in expected}, expected)
        self.assertGreaterEqual(counts["allocate"], 1)

    def test_another_program_is_left_alone(self):
        returned, counts, code, _ = self.run_with("write", 1, "EIO", program="other-calls")
        self.assertEqual((returned["write"], code, sum(counts.values())), ((10, 0), 0, 0))

    def test_the_chosen_call_fails_and_no_other(self):
        calls = {"open": "open", "read": "pread", "write": "write", "sync": "fsync", "close": "close", "rename": "rename",
                 "unlink": "unlink", "link": "symlink", "truncate": "ftruncate", "mkdir": "mkdir"}
        sound = self.run_with()[0]
        for kind, name in calls.items():
            for how, number in (("EIO", 5), ("ENOSPC", 28), ("EINTR", 4)):
                returned, _, _, where = self.run_with(kind, 1, how)
                failed = {call for call in sound if returned[call] != sound[call]}
                self.assertIn(name, failed, (kind, how))
                self.assertEqual(returned[name], (0 if kind == "open" else -1, number))
                self.assertTrue(where.startswith(f"{name} "), where)

    def test_children_go_on_counting(self):
        returned, _, _, _ = self.run_with("mkdir", 2, "EIO")
        self.assertEqual((returned["mkdir"], returned["child"]), ((0, 0), (7, 0)))
        returned, _, _, _ = self.run_with("mkdir", 1, "EIO", on="1")
        self.assertEqual((returned["mkdir"], returned["child"]), ((-1, 5), (7, 0)))

    def test_short_transfers(self):
        self.assertEqual(self.run_with("write", 1, "short")[0]["write"], (5, 0))
        self.assertEqual(self.run_with("read", 1, "short")[0]["pread"], (5, 0))

    def test_memory(self):
        failed = [number for number in range(1, 6) if self.run_with("allocate", number, "ENOMEM")[0].get("malloc") == (0, 12)]
        self.assertEqual(len(failed), 1)

    def test_places_of_allocations(self):
        places = self.folder / "places"
        places.write_bytes(b"")
        _, counts, _, _ = self.run_with(places=places)
        content = places.read_bytes()
        found = collections.Counter(content[at:at + 8] for at in range(0, len(content), 8))
        self.assertEqual(sum(found.values()), counts["allocate"])
        self.assertEqual(sorted(found.values()), [1, 3], "the one that is told of, and that of the loop")

    def test_kills(self):
        for how, names in (("kill-before", {"a"}), ("kill-after", {"b"})):
            _, _, code, _ = self.run_with("rename", 1, how)
            self.assertEqual((code, {path.name for path in (self.folder / "work").iterdir()}), (-signal.SIGKILL, names))


class FileStatesTest(unittest.TestCase):
    def test_what_differs_between_runs_is_left_out_and_nothing_else(self):
        with tempfile.TemporaryDirectory() as name:
            folders = [pathlib.Path(name) / str(number) for number in range(2)]
            for number, folder in enumerate(folders):
                folder.mkdir()
                report = {"wall_s": number, "scans": 7, "stages": {"read": number, "names": ["a"]}}
                (folder / "report.json").write_text(json.dumps(report))
                (folder / "table.tsv").write_text(f"a\t{number}\nb\t{number}\n")
            keys = file_states.volatile_keys(folders)
            self.assertEqual(keys, {"/wall_s", "/stages/read", "/column 1"})
            self.assertEqual(file_states.digests_of(folders[0], keys), file_states.digests_of(folders[1], keys))
            (folders[1] / "report.json").write_text(json.dumps({**report, "scans": 8}))
            self.assertEqual(file_states.differences(file_states.digests_of(folders[1], keys),
                                                     file_states.digests_of(folders[0], keys)), "other: report.json")

    def test_names_of_leftovers(self):
        for name in ("out/.gdtslam-staging-12", "out/.gdtslam-staging-12-2/.old/map.pgm", ".map.png.31-4.tmp", "runs/.latest-7"):
            self.assertTrue(LEFTOVER.search(name), name)
        for name in ("out/map.pgm", "out/.gdtslam-staging", ".map.tmp", "notes.tmp"):
            self.assertFalse(LEFTOVER.search(name), name)


if __name__ == "__main__":
    FailingCallsTest.library = sys.argv.pop(1)
    unittest.main()
