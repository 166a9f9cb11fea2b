"""The commands of docs/release.md with keys that are thrown away: what was signed passes, whatever was changed does not."""

import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

PAGE = pathlib.Path(__file__).resolve().parents[2] / "docs/release.md"
SUMS, SIGN, VERIFY = (line.split("    #")[0] for line in re.search(r"```sh\ncd release\n(.*?)```", PAGE.read_text(), re.S)[1].splitlines())


class Signatures(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.work = pathlib.Path(folder.name)
        for name in ("key", "other"):
            subprocess.run(["ssh-keygen", "-q", "-t", "ed25519", "-N", "", "-f", self.work / name], check=True)
        (self.work / "signers").write_text("NAME " + (self.work / "key.pub").read_text())
        self.release = self.work / "release"
        self.release.mkdir()
        (self.release / "gdtslam-1.0.tar.gz").write_bytes(b"bundle" * 1000)
        (self.release / "gdtslam_1.0_amd64.deb").write_bytes(b"deb")

    def run_line(self, line, key="key"):
        line = line.replace("~/.ssh/release_key", str(self.work / key))
        return subprocess.run(["bash", "-c", line], cwd=self.release, capture_output=True, text=True, check=False)

    def sign(self, key="key", line=SIGN):
        for step in (SUMS, line):
            self.assertEqual(self.run_line(step, key).returncode, 0, step)

    def test_what_was_signed_passes_and_any_change_is_seen(self):
        self.sign()
        self.assertEqual(self.run_line(VERIFY).returncode, 0, self.run_line(VERIFY).stderr)
        for path in sorted(self.release.iterdir()):
            whole = path.read_bytes()
            middle = len(whole) // 2
            for changed in (whole[:middle] + bytes([whole[middle] ^ 1]) + whole[middle + 1:], whole[:middle], b""):
                path.write_bytes(changed)
                self.assertNotEqual(self.run_line(VERIFY).returncode, 0, path.name)
            path.write_bytes(whole)

    def test_sums_of_others_do_not_help(self):
        self.sign()
        (self.release / "gdtslam-1.0.tar.gz").write_text("another program")
        subprocess.run("sha256sum --binary gdtslam* >SHA256SUMS", shell=True, cwd=self.release, check=True)
        self.assertNotEqual(self.run_line(VERIFY).returncode, 0)

    def test_another_key_or_purpose_does_not_count(self):
        for key, line in (("other", SIGN), ("key", SIGN.replace("gdtslam-release", "file"))):
            self.sign(key, line)
            self.assertNotEqual(self.run_line(VERIFY).returncode, 0, line)
            for made in self.release.glob("SHA256SUMS*"):
                made.unlink()


if __name__ == "__main__":
    sys.exit(77) if not shutil.which("ssh-keygen") else unittest.main(verbosity=2)
