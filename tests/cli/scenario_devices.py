"""Devices: what is there, what is taken, what fails, what is verified."""

import ctypes.util
import gzip
import json
import os
import pathlib
import shutil
import signal
import subprocess
import time

import cli_support as cli
from cli_support import (LOG, PROGRAM, SOURCE, command, environment, expect, expect_exit, fresh_folder, mapped, one_error_line,
                         require_vulkan, results, skip)

NO_DRIVER = {"VK_DRIVER_FILES": "/dev/null/none", "VK_ICD_FILENAMES": "/dev/null/none", "VK_ADD_DRIVER_FILES": None}
SAMPLE = SOURCE / "assets/logs/office-start.log.gz"
EXPECTED = SOURCE / "assets/expected/office-start.json"


def has_vulkan_part():
    return json.loads(command("doctor", "--devices", "--json").stdout)["vulkan"]["built"]


def everything_works_without(changes, words, scenario):
    """Commands without a Vulkan device: each says so in one line, and the CPU does its work."""
    env = environment(**changes)
    process = command("doctor", "--devices", env=env)
    expect_exit(process, 0)
    lines = [line for line in process.stdout.splitlines() if line.startswith("vulkan")]
    expect(len(lines) == 1 and words in lines[0], f"doctor: {process.stdout}")
    expect(process.stderr == "", f"doctor: {process.stderr}")
    folder = fresh_folder(f"without_vulkan_{scenario}")
    for arguments in (["map", LOG, "-o", folder / "no"], ["verify"]):
        for device in ("vulkan", "vulkan:0"):
            process = command(*arguments, "--device", device, env=env)
            expect_exit(process, 69)
            one_error_line(process.stderr)
            expect(f"--device {device}: " in process.stderr and words in process.stderr, process.stderr)
            expect(process.stdout == "", process.stdout)
    expect(not (folder / "no").exists(), "a folder of results without results")
    for device in ("auto", "cpu"):
        report = mapped(folder / device, "--first", 20, "--device", device, env=env)
        expect(report["device"]["kind"] == "cpu", f"--device {device} took {report['device']}")
    expect_exit(command("verify", "seed_scatter", "--device", "cpu", env=env), 0)


def no_vulkan_driver():
    """A loader that finds no driver."""
    if not has_vulkan_part():
        everything_works_without({}, "this build has no Vulkan backend", "no_vulkan_driver")
        return
    if ctypes.util.find_library("vulkan") is None:
        skip("there is no Vulkan loader here")
    everything_works_without(NO_DRIVER, "no driver", "no_vulkan_driver")


def vulkan_driver_that_does_not_load():
    """A driver is installed and a library that it needs is not: the message leads to the loader's own, which names it."""
    if not has_vulkan_part() or ctypes.util.find_library("vulkan") is None:
        skip("there is no Vulkan loader here")
    folder = fresh_folder("driver_does_not_load")
    (folder / "libdriver.so").write_text("no library")
    driver = {"file_format_version": "1.0.0", "ICD": {"library_path": str(folder / "libdriver.so"), "api_version": "1.3.0"}}
    (folder / "driver.json").write_text(json.dumps(driver))
    file = str(folder / "driver.json")
    env = environment(VK_DRIVER_FILES=file, VK_ICD_FILENAMES=file, VK_ADD_DRIVER_FILES=None, VK_LOADER_DEBUG=None)
    process = command("doctor", "--devices", env=env)
    expect_exit(process, 0)
    line = next(line for line in process.stdout.splitlines() if line.startswith("vulkan"))
    expect("no driver" in line and "VK_LOADER_DEBUG=error" in line, line)
    expect("libdriver.so" in command("doctor", "--devices", env={**env, "VK_LOADER_DEBUG": "error"}).stderr, "the loader names no library")


def no_vulkan_loader():
    """No loader: a file of its name that is no library stands in its way."""
    if not has_vulkan_part():
        skip("this build has no Vulkan backend")
    folder = fresh_folder("no_loader")
    (folder / "libvulkan.so.1").write_text("")
    everything_works_without({"LD_LIBRARY_PATH": str(folder)}, "libvulkan", "no_vulkan_loader")


def auto_leaves_lavapipe_alone():
    """--device auto takes hardware only; --device vulkan takes what there is."""
    devices = require_vulkan()
    hardware = [device for device in devices if device["kind"] in ("discrete", "integrated", "virtual")]
    folder = fresh_folder("auto")
    chosen = mapped(folder / "auto", "--first", 20)["device"]
    expect((chosen["kind"] == "cpu") == (not hardware), f"auto took {chosen} of {devices}")
    named = mapped(folder / "vulkan", "--first", 20, "--device", "vulkan")["device"]
    expect(named["name"] == (hardware or devices)[0]["name"], f"vulkan took {named}")


def missing_vulkan_device():
    """A number that no device has: exit 69, and which there are."""
    devices = require_vulkan()
    process = command("map", LOG, "-o", fresh_folder("missing") / "out", "--device", "vulkan:77")
    expect_exit(process, 69)
    one_error_line(process.stderr)
    expect("there is no such device, only vulkan:0" in process.stderr and devices[0]["name"] in process.stderr, process.stderr)


def vulkan_gives_the_same_bytes():
    """Matchers on the CPU and on each device: the same map and trajectory. The device works for the matchers
    that follow the slope, gauss-newton and exhaustive, and for no other."""
    devices = require_vulkan()
    folder = fresh_folder("vulkan")
    schema = json.loads(command("config", "schema").stdout)
    scans = {"pso": 6, "sce": 12, "simpsa": 12, "certified": 20}  # the slow ones
    for matcher in schema["properties"]["match"]["properties"]["matcher"]["enum"]:
        arguments = ["--first", scans.get(matcher, 60), "--matcher", matcher]
        cpu = mapped(folder / f"cpu-{matcher}", *arguments, "--device", "cpu")
        for device in devices:
            report = mapped(folder / f"{device['device'].replace(':', '')}-{matcher}", *arguments, "--device",
                            device["device"], "--no-fallback")
            expect(report["device"]["name"] == device["name"], f"mapped on {report['device']}")
            expect(results(report) == results(cpu), f"{matcher}: another result on {device['name']}")
            submissions = report["submissions"]  # none to a CPU, whose kernels count as dispatches
            expect((submissions > 0) == (matcher in ("gauss-newton", "exhaustive")), f"{matcher}: {submissions} submissions")
            work = report.get("device_work")
            expect((work is not None) == (submissions > 0), f"{matcher}: {work}")
            if work:
                sums = {key: work["mapping"][key] + work["adjusting"][key] for key in work["mapping"]}
                expect((sums["dispatches"], sums["submissions"]) == (report["dispatches"], submissions), f"{work}")
                expect(0 < work["adjusting"]["dispatches"] <= 20 and sums["wait_s"] < report["wall_s"], f"{work}")


def register_on_vulkan():
    """A device bounds the places of the walls and scores heights: the same numbers."""
    require_vulkan()
    found = [command("register", cli.DATA / "room.ply", cli.DATA / "room_moved.ply", "--json", "--device", device).stdout
             for device in ("cpu", "vulkan")]
    expect(found[0] == found[1] and '"registered"' in found[0], f"{found}")


def verify_passes():
    """The whole verification of the first device: no difference."""
    device = require_vulkan()[0]
    process = command("verify", "--device", device["device"], "--json", timeout=280)
    expect_exit(process, 0)
    cli.validate(process.stdout, "verify")
    report = json.loads(process.stdout)
    expect(report["differences"] == 0 and report["passed"] is True, "differences with exit 0")
    target = report["targets"][0]
    expect(target["decoys"] == len(target["kernels"]) >= 12, f"{target['decoys']} decoys of {len(target['kernels'])} kernels")
    expect(target["submissions"] >= target["dispatches"] > 1000, f"{target['dispatches']} dispatches")
    shipped = {(name, run["matcher"], run["loops"]): run for name in ("office-start", "nodding-start")
               for run in json.loads(EXPECTED.with_name(f"{name}.json").read_text())["runs"]}
    found = {(pathlib.Path(log["log"]).name.split(".")[0], log["matcher"], log["loops"]): log for log in target["logs"]}
    expect(set(found) == set(shipped) and len(found) == 4, f"{set(found)}")
    for which, log in found.items():
        for side in ("reference", "device"):
            expect(results(log[side]) == results(shipped[which]), f"{which} on {side} is not as shipped")
            expect((log[side]["cloud_sha256"] or "") == shipped[which]["cloud_sha256"], f"the cloud of {which} on {side} is not as shipped")
        # Each scan is matched on the device, but not those of a nodding laser between two that fix the pose.
        matched = 0 if log["device"]["cloud_sha256"] else log["scans"] - 1
        expect(log["device"]["dispatches"] > matched and log["device"]["submissions"] > 0, f"{log['device']}")
        expect(log["device"]["copy_equal"], "copy")


def verify_of_a_device_that_fails():
    """A device that fails on the way: exit 1, and what failed."""
    device = require_vulkan()[0]["device"]
    env = failing("vkQueueSubmit", 25)
    process = command("verify", "--device", device, env=env)
    expect_exit(process, 1)
    one_error_line(process.stderr)
    expect(process.stdout.splitlines()[-1] == f"FAIL: {device} failed; 0 differences until then", process.stdout)
    failed = command("verify", "--device", device, "--json", env=env)
    expect_exit(failed, 1)
    cli.validate(failed.stdout, "verify")
    report = json.loads(failed.stdout)
    expect(report["passed"] is False and "ErrorDeviceLost" in report["targets"][-1]["failure"], failed.stdout)


def copy_of_the_program(name):
    """The program as it is installed, with its logs and expected results, to be damaged."""
    folder = fresh_folder(name)
    (folder / "bin").mkdir()
    shutil.copy2(PROGRAM, folder / "bin/gdtslam")
    (folder / "share/gdtslam").mkdir(parents=True)
    for kind in ("logs", "expected"):
        shutil.copytree(SOURCE / "assets" / kind, folder / "share/gdtslam" / kind)
    return folder


def verify_finds_results_that_are_not_as_shipped():
    """Exit 1, the fault named, the last line the verdict with the number of differences."""
    folder = copy_of_the_program("not_as_shipped")
    program, expected = folder / "bin/gdtslam", folder / "share/gdtslam/expected/office-start.json"
    process = subprocess.run([program, "verify", "logs", "--device", "cpu"], capture_output=True, text=True, check=False)
    expect_exit(process, 0)
    expect(process.stdout.splitlines()[-1] == "PASS: 0 differences", process.stdout)
    wrong = json.loads(expected.read_text())
    wrong["runs"][0]["map_sha256"] = "0" * 64
    expected.write_text(json.dumps(wrong))
    process = subprocess.run([program, "verify", "logs", "--device", "cpu"], capture_output=True, text=True, check=False)
    expect_exit(process, 1)
    one_error_line(process.stderr)
    expect("DIFFERENT: map" in process.stdout and "shipped 000000000000" in process.stdout, process.stdout)
    last = process.stdout.splitlines()[-1]
    expect(last.startswith("FAIL: ") and "difference" in last, last)
    expect(last.startswith("FAIL: ") and int(last.split()[1]) >= 1, last)


def interrupt_of_verify():
    """A signal ends it with 130."""
    for arguments in (["--device", "cpu", "--random", "1000000"], ["logs", "--device", "cpu", *["--log", str(LOG)] * 20]):
        process = subprocess.Popen([PROGRAM, "verify", *arguments], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        time.sleep(1.0)
        process.send_signal(signal.SIGINT)
        output, error = process.communicate(timeout=60 * cli.SLOWNESS)
        expect(process.returncode == 130, f"exit {process.returncode}: {output} {error}")
        one_error_line(error)


def sample_log_can_be_made_again():
    """The simulator gives the sample log and its truth, and the mapper the expected results, as MANIFEST says."""
    if "Not in this build" in command("simulate", "--help").stdout:
        skip("this build has no simulator")
    folder = fresh_folder("sample")
    path = SOURCE / "assets/logs/office-start.path.yaml"
    expect_exit(command("simulate", "office-loop", "--trajectory", path, "--rate", 6, "--seed", 1, "-o",
                        folder / "office-start.log.gz"), 0)
    # The text: another zlib may compress it otherwise.
    expect(gzip.decompress((folder / "office-start.log.gz").read_bytes()) == gzip.decompress(SAMPLE.read_bytes()), "the log")
    expect((folder / "office-start.truth.tum").read_bytes() == SAMPLE.with_name("office-start.truth.tum").read_bytes(), "truth")
    expect_exit(command("verify", "--write-expected", folder / "expected.json"), 0)
    expect((folder / "expected.json").read_bytes() == EXPECTED.read_bytes(), "the expected results")
    process = command("verify", "--write-expected", LOG / "below-a-file.json")
    expect_exit(process, 74)


def failing(call, at):
    """An environment in which a call of the driver fails."""
    loader = os.environ.get("FAILING_VULKAN")
    real = ctypes.util.find_library("vulkan")
    if loader is None or real is None:
        skip("the failing loader cannot be used here")
    folder = fresh_folder("failing")
    shutil.copy2(loader, folder / "libvulkan.so.1")
    paths = subprocess.run(["/sbin/ldconfig", "-p"], capture_output=True, text=True, check=True).stdout
    real_path = next(line.split("=> ")[1] for line in paths.splitlines() if line.strip().startswith(real))
    return environment(LD_LIBRARY_PATH=str(folder), FAILING_VULKAN_REAL=real_path, FAILING_VULKAN_CALL=call,
                       FAILING_VULKAN_AT=str(at))


def device_that_fails():
    """A driver that fails at once or on the way: one warning and the CPU's result, or exit 1 with the call's name."""
    require_vulkan()
    folder = fresh_folder("fails")
    arguments = ["--first", 40, "--matcher", "exhaustive", "--device", "vulkan"]
    wanted = results(mapped(folder / "cpu", *arguments[:-1], "cpu"))
    for driver_call, call, at, code in (("vkCreateDevice", "vkCreateDevice", 1, "DeviceLost"),
                                        ("vkAllocateMemory", "vkAllocateMemory", 1, "OutOfDeviceMemory"),
                                        ("vkQueueSubmit", "vk::Queue::submit", 1, "DeviceLost"),
                                        ("vkQueueSubmit", "vk::Queue::submit", 25, "DeviceLost")):
        env = failing(driver_call, at)
        process = command("map", LOG, "-o", folder / "out", "--force", "--json", *arguments, env=env)
        expect_exit(process, 0)
        warnings = process.stderr.splitlines()
        expect(len(warnings) == 1 and warnings[0].startswith("gdtslam: warning: ") and call in warnings[0], process.stderr)
        expect(results(json.loads(process.stdout)) == wanted, f"{call} number {at}: another result")
        process = command("map", LOG, "-o", folder / "no", *arguments, "--no-fallback", env=env)
        expect_exit(process, 1)
        one_error_line(process.stderr)
        expect(call in process.stderr and code in process.stderr, process.stderr)
        expect(not (folder / "no").exists(), "a folder of results without results")
        process = command("verify", "seed_scatter", "--device", "vulkan", env=env)
        if at == 1:
            expect_exit(process, 1)
            one_error_line(process.stderr)
            expect(call in process.stderr, process.stderr)
            expect(process.stdout == "" or process.stdout.splitlines()[-1].startswith("FAIL: "), process.stdout)


def merge_on_a_device_that_fails():
    """One warning and the CPU's result, or exit 1 with the call's name."""
    require_vulkan()
    folder = fresh_folder("merge_fails")
    mapped(folder / "early", "--first", 210)
    mapped(folder / "late", "--skip", 140)
    runs = ["merge", folder / "early", folder / "late", "--device"]
    expect_exit(command(*runs, "cpu", "-o", folder / "cpu", "-q"), 0)
    env = failing("vkQueueSubmit", 2)
    process = command(*runs, "vulkan", "-o", folder / "out", "-q", env=env)
    expect_exit(process, 0)
    expect(process.stderr.count("\n") == 1 and "vk::Queue::submit" in process.stderr, process.stderr)
    paths = [(folder / name / "1/trajectory.tum").read_bytes() for name in ("cpu", "out")]
    expect(paths[0] == paths[1], "another path")
    process = command(*runs, "vulkan", "-o", folder / "no", "-q", "--no-fallback", env=env)
    expect_exit(process, 1)
    one_error_line(process.stderr)


def gpu_is_looked_for_when_needed():
    """--device auto asks the Vulkan loader for devices only where a run has work for one; a device that is named is opened always."""
    if not has_vulkan_part() or ctypes.util.find_library("vulkan") is None:
        skip("there is no Vulkan here")
    folder = fresh_folder("gpu_when_needed")
    nodding = SOURCE / "assets/logs/nodding-start.log.gz"
    for log, arguments, is_needed in ((SAMPLE, (), False), (SAMPLE, ("--matcher", "exhaustive"), True), (nodding, (), True)):
        process = command("map", log, "-o", folder / "run", "--force", "--first", 20, "--no-pictures", "-q", *arguments,
                          env=environment(VK_LOADER_DEBUG="all", **NO_DRIVER))
        expect_exit(process, 0)
        has_looked = "vkCreateInstance" in process.stderr or "ICD" in process.stderr or "DRIVER" in process.stderr
        expect(has_looked == is_needed, f"{log.name} {arguments}: {process.stderr[:2000]}")
    expect_exit(command("map", SAMPLE, "-o", folder / "no", "--device", "vulkan", env=environment(**NO_DRIVER)), 69)


def bench_work_of_a_device():
    """What mapping the sample asks of a device adds up to what report.json counts, and does not depend on the run."""
    device = require_vulkan()[0]["device"]
    texts = []
    for _ in range(2):
        process = command("bench", "work/", "--device", device, "--log", cli.LOG, "--benchmark_format=json")
        expect_exit(process, 0)
        kinds = json.loads(process.stdout)["benchmarks"]
        expect([kind["run_name"].split("/")[2] for kind in kinds] == ["keyframe", "other scan"], f"{kinds}")
        texts.append(json.dumps([{key: value for key, value in kind.items() if key not in ("real_time", "cpu_time", "device_s")}
                                 for kind in kinds]))
    expect(texts[0] == texts[1], f"{texts}")
    folder = cli.fresh_folder("work_of_a_device")
    process = command("map", cli.LOG, "-o", folder / "run", "--no-loops", "--matcher", "exhaustive", "--device", device, "--no-pictures",
                      "--json")
    expect_exit(process, 0)
    report = json.loads(process.stdout)

    def total(key):
        return round(sum(kind["scans"] * kind[key] for kind in kinds))

    expect(sum(kind["scans"] for kind in kinds) == report["scans"], f"{kinds}")
    expect(kinds[0]["scans"] == report["keyframes"], f"{kinds}: {report['keyframes']}")
    for key in ("dispatches", "submissions"):
        expect(total(key) == report[key], f"{key}: {total(key)}, {report[key]}")
    for kind in kinds:
        kernels = [value for key, value in kind.items() if key.startswith("kernel ")]
        expect(kernels and abs(sum(kernels) - kind["dispatches"]) < 1e-6, f"{kind}")
