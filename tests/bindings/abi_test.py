"""The ABI is the one that is stored: abidw reads functions, types and constants of gdtslam.h, abidiff compares.

What is read is a library in C that defines every function of the header with an empty body. So neither the handles'
insides nor the C++ library count, and no debug information of the product is needed; that the product has these
functions is what its compiler (extern "C") and the test of its symbols see to.

Any difference fails. What is added on purpose is stored with GDTSLAM_UPDATE_GOLDENS=1; what abidiff calls incompatible
takes another number behind .so.
"""
import os
import re
import subprocess
import sys

from bindings_support import HEADER, SOURCE, fail, folder, run, skip_without

abidw = skip_without("abidw", "abigail-tools")
abidiff = skip_without("abidiff", "abigail-tools")
STORED = SOURCE / "tests/bindings/abi/libgdtslam.so.0.xml"
INCOMPATIBLE = 8  # a bit of abidiff's exit code


def empty_bodies(header):
    """C with a definition of every function, and a type whose members are as large as the constants are."""
    declarations = re.findall(r"^GDTSLAM_API ([^;]+);", header, re.MULTILINE)
    constants = sorted(set(re.findall(r"\b(GDTSLAM_[A-Z_]+) = ", header)))
    if len(declarations) < 40 or len(constants) < 30:
        fail("the header has another form than this test reads")
    bodies = [text + (" {}" if text.startswith("void ") else " { return 0; }") for text in declarations]
    members = "".join(f"  char {name}_[1 + {name}];\n" for name in constants)
    return (
        '#include "gdtslam.h"\n' + "\n".join(bodies) + f"\nstruct gdtslam_constants {{\n{members}}};\n"
        "int gdtslam_constants_of(const struct gdtslam_constants* all);\n"
        "int gdtslam_constants_of(const struct gdtslam_constants* all) { return all->GDTSLAM_OK_[0]; }\n"
    )


def abi_of(place, header):
    """The ABI of such a header, as a file."""
    place.mkdir()
    (place / "gdtslam.h").write_text(header)
    (place / "gdtslam.c").write_text(empty_bodies(header))
    run(os.environ["GDTSLAM_C_COMPILER"], "-std=c99", "-g", "-O0", "-fPIC", "-shared", "-Wl,-soname,libgdtslam.so.0",
        "-o", "libgdtslam.so", "gdtslam.c", cwd=place)
    run(abidw, "--no-corpus-path", "--no-comp-dir-path", "--no-show-locs", "--no-elf-needed", "--out-file", "abi.xml",
        "libgdtslam.so", cwd=place)
    return place / "abi.xml"


def difference(old, new):
    """abidiff's exit code and what it says."""
    done = subprocess.run([abidiff, "--no-show-locs", str(old), str(new)], capture_output=True, text=True)
    if done.returncode & 3:
        fail(f"abidiff itself failed: {done.stdout}{done.stderr}")
    return done.returncode, done.stdout


work = folder("abi")
header = HEADER.read_text()
current = abi_of(work / "current", header)
changes = {
    "a member that moves": ("  double stamp_s;\n  double first_bearing_rad;", "  double first_bearing_rad;\n  double stamp_s;"),
    "a member that goes": ("  double beam_period_s;\n", ""),
    "a member of another type": ("  uint64_t laser;", "  int32_t laser;"),
    "an argument that comes": ("gdtslam_doubt_name(int32_t doubt);", "gdtslam_doubt_name(int32_t doubt, int32_t more);"),
    "a constant of another value": ("GDTSLAM_AMBIGUOUS = 1,", "GDTSLAM_AMBIGUOUS = 4,"),
    "a function that goes": ("GDTSLAM_API const char* gdtslam_version(void);", ""),
    "a function that comes": ("GDTSLAM_API const char* gdtslam_version(void);",
                              "GDTSLAM_API const char* gdtslam_version(void);\nGDTSLAM_API int gdtslam_more(void);"),
}
for number, (name, (old, new)) in enumerate(changes.items()):
    if old not in header:
        fail(f"the header has no longer what the case '{name}' changes")
    status, words = difference(current, abi_of(work / str(number), header.replace(old, new)))
    if not status:
        fail(f"abidiff does not see {name}")
    if "that goes" in name and "function" in name and not status & INCOMPATIBLE:
        fail(f"abidiff calls {name} compatible")
if difference(current, abi_of(work / "again", header))[0] != 0:
    fail("abidiff sees a change where there is none")
if os.environ.get("GDTSLAM_UPDATE_GOLDENS") == "1":
    STORED.parent.mkdir(exist_ok=True)
    STORED.write_bytes(current.read_bytes())
    print(f"stored {STORED}")
    sys.exit(0)
status, words = difference(STORED, current)
if status:
    kind = "incompatible" if status & INCOMPATIBLE else "another"
    fail(f"the ABI is {kind} than {STORED}:\n{words}\nWhat was only added is stored with GDTSLAM_UPDATE_GOLDENS=1.")
print("the stored ABI")
