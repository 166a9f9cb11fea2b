"""tools/scripts/sign_release.sh with keys that are thrown away: what was signed passes, whatever was changed does not."""

import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import time
import unittest

SCRIPT = pathlib.Path(__file__).resolve().parents[2] / "tools/scripts/sign_release.sh"
SKIPPED = 77


class Signed:
    """The tests of both kinds of keys."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.work = pathlib.Path(folder.name)
        self.release = self.work / "release"
        self.release.mkdir()
        (self.release / "gdtslam-1.0.tar.gz").write_bytes(os.urandom(5000))
        (self.release / "gdtslam_1.0~rc1_amd64.deb").write_bytes(b"deb")
        self.make_keys()

    def run_script(self, *arguments):
        return subprocess.run([SCRIPT, *map(str, arguments)], env=self.environment, capture_output=True, text=True, check=False)

    def sign(self, key=None):
        done = self.run_script(self.option, key or self.key, self.release)
        self.assertEqual(done.returncode, 0, done.stderr)

    def expect_refused(self, says, signers=None):
        done = self.run_script("--verify", signers or self.signers, self.release)
        self.assertEqual(done.returncode, 65, done.stdout + done.stderr)
        self.assertEqual(len(done.stderr.splitlines()), 1, done.stderr)
        self.assertIn(says, done.stderr)
        self.assertNotIn("what was signed", done.stdout)

    def test_what_was_signed_passes(self):
        self.sign()
        done = self.run_script("--verify", self.signers, self.release)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("signed by " + self.signer, done.stdout)
        self.assertIn("2 files are what was signed", done.stdout)
        checked = subprocess.run(["sha256sum", "--check", "SHA256SUMS"], cwd=self.release, capture_output=True, text=True, check=False)
        self.assertEqual(checked.returncode, 0, checked.stderr)  # without our script, too

    def test_any_change_is_seen(self):
        self.sign()
        for name in sorted(path.name for path in self.release.iterdir()):
            whole = (self.release / name).read_bytes()
            middle = len(whole) // 2
            for changed in (whole[:middle] + bytes([whole[middle] ^ 1]) + whole[middle + 1:], whole[:middle], b""):
                (self.release / name).write_bytes(changed)
                done = self.run_script("--verify", self.signers, self.release)
                self.assertEqual(done.returncode, 65, f"{name}: {done.stdout}")
            (self.release / name).unlink()
            done = self.run_script("--verify", self.signers, self.release)
            self.assertEqual(done.returncode, 65, f"{name} is gone: {done.stdout}")
            (self.release / name).write_bytes(whole)
        (self.release / "other.deb").write_text("slipped in")
        self.expect_refused("not those of SHA256SUMS")

    def test_files_that_are_named_like_sums_are_files_like_any(self):
        self.sign()
        mark = next(name for name in ("SHA256SUMS.asc", "SHA256SUMS.sig") if not (self.release / name).exists())
        for name in ("SHA256SUMS-gdtslam_1.0_amd64.deb", mark):
            (self.release / name).write_text("slipped in")
            self.expect_refused("SHA256SUMS")
            (self.release / name).unlink()

    def test_sums_of_others_do_not_help(self):
        self.sign()
        (self.release / "gdtslam-1.0.tar.gz").write_text("another program")
        with open(self.release / "SHA256SUMS", "w", encoding="ascii") as sums:
            subprocess.run(["sha256sum", "--binary", "gdtslam-1.0.tar.gz", "gdtslam_1.0~rc1_amd64.deb"], cwd=self.release, stdout=sums, check=True)
        self.expect_refused("SHA256SUMS")

    def test_a_key_of_somebody_else_does_not_count(self):
        self.sign(self.other_key)
        self.expect_refused("SHA256SUMS")

    def test_odd_names_are_not_signed(self):
        for name in ("a b", "a\nb", "-x", "caf\u00e9", "a;b", "$(x)"):
            (self.release / name).write_text("x")
            done = self.run_script(self.option, self.key, self.release)
            self.assertEqual(done.returncode, 65, f"{name!r}: {done.stderr}")
            (self.release / name).unlink()
        (self.release / "link").symlink_to("/etc/passwd")
        self.assertEqual(self.run_script(self.option, self.key, self.release).returncode, 65)


@unittest.skipUnless(shutil.which("ssh-keygen"), "no ssh-keygen here")
class Ssh(Signed, unittest.TestCase):
    option, signer = "--ssh", "maintainer@example.org"

    def make_keys(self):
        self.environment = dict(os.environ)
        for name in ("key", "other"):
            subprocess.run(["ssh-keygen", "-q", "-t", "ed25519", "-N", "", "-C", name, "-f", self.work / name], check=True)
        self.key, self.other_key, self.signers = self.work / "key", self.work / "other", self.work / "signers"
        self.signers.write_text(f"{self.signer} " + (self.work / "key.pub").read_text())

    def test_a_signature_for_another_purpose_does_not_count(self):
        self.sign()
        (self.release / "SHA256SUMS.sig").unlink()
        subprocess.run(["ssh-keygen", "-Y", "sign", "-q", "-f", self.key, "-n", "file", self.release / "SHA256SUMS"], check=True)
        self.expect_refused("no signature of SHA256SUMS")


@unittest.skipUnless(shutil.which("gpg") and shutil.which("gpgv"), "no gpg here")
class Gpg(Signed, unittest.TestCase):
    option, signer = "--gpg", ""

    def make_keys(self):
        home = self.work / "gnupg"
        home.mkdir(mode=0o700)
        self.environment = {**os.environ, "GNUPGHOME": str(home)}
        self.addCleanup(lambda: subprocess.run(["gpgconf", "--kill", "all"], env=self.environment, check=False))
        self.key, self.other_key, self.signers = "maintainer@example.org", "other@example.org", self.work / "signers.gpg"
        for name in (self.key, self.other_key):
            subprocess.run(["gpg", "--batch", "--quiet", "--passphrase", "", "--quick-generate-key", name, "ed25519", "sign"], env=self.environment,
                           check=True, capture_output=True)
        self.export_keys()

    def export_keys(self):
        self.signers.write_bytes(subprocess.run(["gpg", "--export", self.key], env=self.environment, check=True, capture_output=True).stdout)

    def gpg(self, *arguments, text=None):
        return subprocess.run(["gpg", "--batch", "--yes", "--quiet", *map(str, arguments)], env=self.environment, input=text, check=True,
                              capture_output=True, text=True).stdout

    def test_a_key_that_was_revoked_does_not_count(self):
        self.sign()
        listed = self.gpg("--list-keys", "--with-colons", self.key)
        fingerprint = next(line.split(":")[9] for line in listed.splitlines() if line.startswith("fpr"))
        # gpg makes the certificate with the key, and a colon before it keeps it from being taken by mistake.
        certificate = self.work / "gnupg/openpgp-revocs.d" / f"{fingerprint}.rev"
        self.gpg("--import", text=certificate.read_text().replace(":-----BEGIN", "-----BEGIN"))
        self.export_keys()
        self.expect_refused("revoked or has expired")

    def test_a_key_that_has_expired_does_not_count(self):
        self.sign()
        listed = self.gpg("--list-keys", "--with-colons", self.key)
        fingerprint = next(line.split(":")[9] for line in listed.splitlines() if line.startswith("fpr"))
        self.gpg("--quick-set-expire", fingerprint, "seconds=1")
        time.sleep(2.1)
        self.export_keys()
        self.expect_refused("revoked or has expired")


class Usage(unittest.TestCase):
    def test_mistakes_are_told(self):
        for arguments, code in (([], 2), (["--ssh", "key"], 2), (["--sign", "key", "/tmp"], 2), (["--ssh", "/nonexistent", "/tmp"], 74),
                                (["--gpg", "key", "/nonexistent"], 74), (["--help"], 0)):
            done = subprocess.run([SCRIPT, *arguments], capture_output=True, text=True, check=False)
            self.assertEqual(done.returncode, code, f"{arguments}: {done.stderr}")


def main():
    missing = [name for name in ("ssh-keygen", "gpg") if not shutil.which(name)]
    if missing:
        print(f"SKIPPED: signatures were not tested with what is not here: {missing}", flush=True)
        if os.environ.get("GDTSLAM_REQUIRE_PROGRAMS") == "1":
            return 1
    done = unittest.TextTestRunner(verbosity=2).run(unittest.defaultTestLoader.loadTestsFromModule(sys.modules[__name__]))
    return 1 if not done.wasSuccessful() else SKIPPED if missing else 0


if __name__ == "__main__":
    sys.exit(main())
