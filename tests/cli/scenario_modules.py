"""Commands that are modules: what the others load, and what is said where a module or its libraries are missing."""

import re
import shutil
import subprocess

import cli_support as cli
from cli_support import LOG, RUN, command, environment, expect, expect_exit, one_error_line

# Of the names of the libraries that only modules need: VTK, OpenGL, the parts of Ceres (which is an archive), OpenCV.
HEAVY = re.compile(r"/lib(vtk|GL|EGL|OpenGL|ceres|glog|cholmod|cxsparse|lapack|f77blas|opencv)[^/]*$")


def require_modules():
    if not cli.MODULES:
        cli.skip("this build has no modules")


def loaded_by(folder, *arguments, **options):
    """The libraries that the loader initialised for a command, by its own account."""
    process = command(*arguments, env=environment(LD_DEBUG="libs", LD_DEBUG_OUTPUT=str(folder / "loaded")), **options)
    expect_exit(process, 0)
    text = "".join(file.read_text(errors="replace") for file in folder.glob("loaded.*"))
    for file in folder.glob("loaded.*"):
        file.unlink()
    return set(re.findall(r"calling init: (\S+)", text))


def commands_load_what_they_need():
    """No library of pictures in 3D, calibration or comparison for a command that has no use for it, and for one that has."""
    require_modules()
    if cli.IS_SANITIZED:
        cli.skip("a sanitized program is linked with more than it needs")
    folder = cli.fresh_folder("commands_load")
    for arguments in (("--version",), ("config", "show"), ("doctor", "--devices"), ("map", LOG, "--first", 50, "-o", folder / "run", "-q"),
                      ("map", "--help"), ("evaluate", RUN / "trajectory.tum", "--reference", RUN / "trajectory.tum")):
        libraries = loaded_by(folder, *arguments)
        expect(any("libstdc++" in path for path in libraries), f"the loader's account is not understood: {libraries}")
        heavy = sorted(path for path in libraries if HEAVY.search(path))
        expect(not heavy, f"gdtslam {arguments[0]} loads {heavy}")
    if (cli.MODULES / "render.so").exists():
        libraries = loaded_by(folder, "render", "--help")
        expect(any("libvtk" in path for path in libraries), f"render without VTK: {sorted(libraries)}")


def missing_modules():
    """A module that is missing, damaged or of another version: exit 69, one line with the module or library and what to do;
    the help lists the command with the reason; what needs no module goes on."""
    require_modules()
    folder = cli.fresh_folder("missing_modules")
    program = cli.installed_copy(folder / "whole")
    names = sorted(file.stem for file in cli.MODULES.glob("*.so"))
    expect(names, f"no modules in {cli.MODULES}")
    alone = cli.installed_copy(folder / "alone", with_modules=False)

    def run(which, *arguments):
        return subprocess.run([which, *map(str, arguments)], capture_output=True, text=True, check=False, timeout=100 * cli.SLOWNESS)

    for name in names:
        process = run(alone, name, "nothing")
        expect_exit(process, 69)
        one_error_line(process.stderr)
        expect(f"'{name}' is not installed: there is no {folder / 'alone'}" in process.stderr, process.stderr)
        expect_exit(run(program, name, "--help"), 0)
    process = run(alone, "--help")
    expect_exit(process, 0)
    expect(process.stdout.count("Not available: ") == len(names), process.stdout)
    expect_exit(run(alone, "map", LOG, "--first", 20, "-o", folder / "run", "-q"), 0)

    module = next((folder / "whole").rglob(f"{names[0]}.so"))
    whole = module.read_bytes()
    for damage, words in ((b"", "file too short"), (b"no module" * 1000, "invalid ELF header"),
                          (whole.replace(version() + b"\0", bytes(len(version())) + b"\0"), "; install the command as a whole")):
        module.write_bytes(damage)
        process = run(program, names[0], "nothing")
        expect_exit(process, 69)
        one_error_line(process.stderr)
        expect(words in process.stderr, process.stderr)
    shutil.rmtree(folder)


def version():
    return command("--version").stdout.split()[1].encode()
