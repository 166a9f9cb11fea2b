#!/usr/bin/env python3
"""Makes a small Debian root from the packages of this machine, without a network: debian_root.py ROOT PACKAGE_OR_DEB...

The root has the essential packages, those named (of a .deb file, what it depends on, but not itself), and all that these
depend on, with a package database that says so. So a package that lacks a dependency lacks its files there, too.
"""

import pathlib
import re
import shutil
import subprocess
import sys

INFO = pathlib.Path("/var/lib/dpkg/info")


def stanzas_of(text):
    for block in text.split("\n\n"):
        fields, name = {}, None
        for line in block.splitlines():
            if line[:1] in (" ", "\t"):
                fields[name] += "\n" + line
            elif ":" in line:
                name, value = line.split(":", 1)
                fields[name] = value.strip()
        if fields:
            yield fields, block


class Database:
    def __init__(self):
        self.packages, self.blocks, self.provided = {}, {}, {}
        for fields, block in stanzas_of(pathlib.Path("/var/lib/dpkg/status").read_text(encoding="utf-8")):
            if fields.get("Status") != "install ok installed":
                continue
            self.packages[fields["Package"]] = fields
            self.blocks[fields["Package"]] = block
            for provided in names_in(fields.get("Provides", "")):
                self.provided.setdefault(provided[0], []).append(fields["Package"])

    def with_name(self, alternatives):
        """The installed package that meets one of the alternatives."""
        for name in alternatives:
            for package in [name, *self.provided.get(name, [])]:
                if package in self.packages:
                    return package
        return None

    def closure(self, wanted):
        """All that these packages depend on, themselves among it."""
        found, queue = set(), list(wanted)
        while queue:
            package = queue.pop()
            if package in found:
                continue
            found.add(package)
            queue += self.dependencies(self.packages[package])
        return sorted(found)

    def dependencies(self, fields, but=()):
        needed = []
        for alternatives in names_in(fields.get("Pre-Depends", "") + ", " + fields.get("Depends", "")):
            if any(name in but for name in alternatives):
                continue
            package = self.with_name(alternatives)
            if package is None:
                sys.exit(f"debian_root: {fields['Package']} needs {' | '.join(alternatives)}, which is not installed here")
            needed.append(package)
        return needed


def names_in(relation):
    """ "a (>= 1) | b, c:any" as [["a", "b"], ["c"]]."""
    groups = [[re.split(r"[\s(:\[]", choice.strip(), maxsplit=1)[0] for choice in group.split("|")] for group in relation.split(",")]
    return [group for group in ([name for name in group if name] for group in groups) if group]


def files_of(package, architecture):
    for name in (f"{package}:{architecture}", package):
        listing = INFO / f"{name}.list"
        if listing.exists():
            return [line[1:] for line in listing.read_text(encoding="utf-8").splitlines() if line not in ("/.", "/")]
    sys.exit(f"debian_root: no list of the files of {package}")


def main():
    root, names = pathlib.Path(sys.argv[1]), sys.argv[2:]
    database = Database()
    debs = [next(stanzas_of(subprocess.run(["dpkg-deb", "--field", name], check=True, capture_output=True, text=True).stdout))[0]
            for name in names if name.endswith(".deb")]
    wanted = [name for name, fields in database.packages.items() if fields.get("Essential") == "yes"]
    wanted += [name for name in names if not name.endswith(".deb")]
    missing = [name for name in wanted if name not in database.packages]
    if missing:
        sys.exit(f"debian_root: not installed on this machine: {' '.join(missing)}")
    for fields in debs:
        wanted += database.dependencies(fields, but={other["Package"] for other in debs})
    packages = database.closure(wanted)

    shutil.rmtree(root, ignore_errors=True)
    for folder in ("usr/bin", "usr/sbin", "usr/lib", "usr/lib64", "var/lib/dpkg/info", "var/lib/dpkg/updates", "var/lib/apt/lists",
                   "var/cache/apt/archives/partial", "var/log", "proc", "dev", "tmp", "root", "home", "run", "etc/apt/apt.conf.d"):
        (root / folder).mkdir(parents=True, exist_ok=True)
    for name in ("bin", "sbin", "lib", "lib64"):
        (root / name).symlink_to(f"usr/{name}")
    paths, status = set(), []
    for package in packages:
        paths.update(files_of(package, database.packages[package]["Architecture"]))
        status.append(database.blocks[package])
        for file in [*INFO.glob(f"{package}.*"), *INFO.glob(f"{package}:*")]:
            shutil.copy2(file, root / "var/lib/dpkg/info" / file.name)
    (root / "var/lib/dpkg/status").write_text("\n\n".join(status) + "\n", encoding="utf-8")
    for name in ("available", "diversions", "statoverride"):
        (root / "var/lib/dpkg" / name).write_text("")
    for folder in ("etc/alternatives", "var/lib/dpkg/alternatives"):
        paths.update(str(path)[1:] for path in pathlib.Path("/", folder).iterdir())
    paths.update(("etc/passwd", "etc/group", "etc/ld.so.conf"))
    there = sorted(path for path in paths if pathlib.Path("/", path).is_symlink() or pathlib.Path("/", path).exists())
    real = [path for path in there if path not in ("bin", "sbin", "lib", "lib64")]
    writer = subprocess.Popen(["tar", "-C", "/", "--no-recursion", "--null", "-T", "-", "-cf", "-"], stdin=subprocess.PIPE,
                              stdout=subprocess.PIPE)
    reader = subprocess.Popen(["tar", "-C", str(root), "--no-same-owner", "--keep-directory-symlink", "-xf", "-"], stdin=writer.stdout)
    writer.stdout.close()
    writer.stdin.write("\0".join(real).encode())
    writer.stdin.close()
    if writer.wait() != 0 or reader.wait() != 0:
        sys.exit("debian_root: the packages' files could not be copied")
    print(f"{len(packages)} packages, {len(real)} files")


if __name__ == "__main__":
    main()
