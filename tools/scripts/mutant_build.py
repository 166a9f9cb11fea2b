"""Compiles a mutant beside a build tree and links programs with it (mutants.py); the sources and the tree stay as they are.

The changed copy of a source is compiled alone, by the command of the object that holds the source in the tree. Where that
object is one of many sources (CMAKE_UNITY_BUILD), a copy of it whose symbols are weak stands behind the mutant's object in the
link: the linker takes the mutant's functions and, of everything else, those of the copy. GCC does not inline functions with a
name of their own across an object of -fPIC, since they may be replaced; what is inline or in an anonymous namespace belongs to
one source. Both objects stand before the static libraries, so that nothing is taken from there that they have.
"""

import json
import pathlib
import re
import shlex
import shutil
import subprocess

from mutant_changes import ROOT

UNITY_INCLUDE = re.compile(r'^#include "(.*)"$', re.MULTILINE)


def run(arguments, check=False, **options):
    return subprocess.run([str(word) for word in arguments], capture_output=True, text=True, errors="replace", check=check, **options)


def has_avx512():
    info = pathlib.Path("/proc/cpuinfo")
    return info.exists() and "avx512" in info.read_text()


def weakened(obj, folder):
    """A copy of an object in which each symbol that it defines is weak. One that it lacks must stay as it is: for a weak one
    the linker looks into no library, and leaves 0."""
    defined = folder / "defined.txt"
    listed = run(["nm", "--defined-only", "--extern-only", "--format=posix", obj], check=True).stdout
    defined.write_text("".join(line.split()[0] + "\n" for line in listed.splitlines()))
    weak = folder / "weak.o"
    run(["objcopy", f"--weaken-symbols={defined}", obj, weak], check=True)
    return weak


class Tree:
    """A build tree made by Ninja with CMAKE_EXPORT_COMPILE_COMMANDS."""

    def __init__(self, build):
        self.build = build.resolve()
        self.links = {}
        self.entries, self.holders = {}, {}
        for entry in json.loads((self.build / "compile_commands.json").read_text()):
            file = pathlib.Path(entry["file"])
            self.entries[file] = entry
            if "/Unity/unity_" in str(file):
                for source in UNITY_INCLUDE.findall(file.read_text()):
                    self.holders[pathlib.Path(source)] = file
            else:
                self.holders[file] = file

    def targets(self):
        listed = run(["ninja", "-C", self.build, "-t", "targets", "all"]).stdout
        return set(re.findall(r"^(\S+): phony", listed, re.MULTILINE)) | set(re.findall(r"^(\S+): \w+_LINKER", listed, re.MULTILINE))

    def compile(self, mutant, folder):
        """The objects that take the place of those of the tree, the mutant's first; None where it does not compile."""
        if mutant.path.suffix == ".inl":
            return self.compile_kernels(mutant, folder)
        source = folder / mutant.path.name
        source.write_text(mutant.source())
        holder = self.holders[ROOT / mutant.path]
        obj = self.compiled(holder, source, folder / "mutant.o", [(ROOT / mutant.path).parent])
        if obj is None or holder == ROOT / mutant.path:
            return obj and [obj]
        return [obj, weakened(self.build / self.output_of(holder), folder)]

    def compile_kernels(self, mutant, folder):
        """Kernels are included into one source for each instruction set: those of this processor are compiled, out of a copy of
        the folder that is found before the real one."""
        here = (ROOT / mutant.path).parent
        copy = folder / "sources" / mutant.path.parent
        shutil.copytree(here, copy)
        (copy / mutant.path.name).write_text(mutant.source())
        objects = []
        for name in ("avx2", "baseline", "avx512")[:3 if has_avx512() else 2]:
            holder = ROOT / "engine/compute/isa" / f"{name}.cpp"
            source = copy / holder.name if here == holder.parent else holder
            objects.append(self.compiled(holder, source, folder / f"{name}.o", [folder / "sources"]))
        return None if None in objects else objects

    def output_of(self, holder):
        words = shlex.split(self.entries[holder]["command"])
        return words[words.index("-o") + 1]

    def compiled(self, holder, source, obj, quoted):
        words = shlex.split(self.entries[holder]["command"])
        words[words.index("-o") + 1] = str(obj)
        words[words.index("-c") + 1] = str(source)
        words[1:1] = [word for folder in quoted for word in ("-iquote", str(folder))]
        # A warning about what a change leaves unused is no reason not to judge it.
        words = [word for word in words if word != "-Werror"] + ["-w"]
        return obj if run(words, cwd=self.build).returncode == 0 else None

    def link_command(self, target):
        if target not in self.links:
            lines = run(["ninja", "-C", self.build, "-t", "commands", target]).stdout.splitlines()
            # `: && compiler ... && :`, what comes behind makes files of the tree and is left out.
            self.links[target] = shlex.split(lines[-1].split("&&")[1])
        return self.links[target]

    def uses(self, target, library):
        return any(word.endswith(f"/lib{library}.a") for word in self.link_command(target))

    def link(self, target, objects, output):
        words = list(self.link_command(target))
        words[words.index("-o") + 1] = str(output)
        first = next(place for place, word in enumerate(words) if word.endswith(".o"))
        words[first:first] = [str(obj) for obj in objects]
        if shutil.which("ld.lld"):
            words.insert(1, "-fuse-ld=lld")
        done = run(words, cwd=self.build)
        return output if done.returncode == 0 else None
