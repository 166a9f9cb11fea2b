"""`gdtslam doctor` on recordings: topics, frames, clocks and the lines to type, against what is written here, and the real
bags against counts by Python's own sqlite3 and struct."""

import collections
import gzip
import json
import os
import pathlib
import shlex
import shutil
import sqlite3
import subprocess

import cli_support as cli
import scenario_bags as bags
from cli_support import command, expect, expect_exit
from recording_reader import Bytes, bag_record, whole

REAL = pathlib.Path(os.environ.get("GDTSLAM_DATA", cli.SOURCE / ".." / "shared" / "data")) / "rosbag"


def examined(log, *arguments, code=0):
    process = command("doctor", log, "--json", *arguments)
    expect_exit(process, code)
    cli.validate(process.stdout, "doctor")
    return json.loads(process.stdout)


def types_here(line, folder):
    """Runs a line that doctor printed, in that folder, with the program under test."""
    words = shlex.split(line)
    expect(words[0] == "gdtslam", line)
    process = subprocess.run([cli.PROGRAM, *words[1:], "--quiet", "--force"], cwd=folder, capture_output=True, text=True,
                             check=False)
    expect(process.returncode == 0, f"{line}: {process.stderr}")
    return json.loads((folder / "out/report.json").read_text())


def two_lasers():
    """The drive of the bags' scenarios, with a second laser half a metre back, a servo, a camera and the odometry twice."""
    data = bags.drive_records() + bags.connection(3, "/rear scan", bags.SCAN)
    data += bags.connection(4, "/tf", bags.TRANSFORM) + bags.connection(5, "/servo", "std_msgs/Float32")
    data += bags.connection(6, "/camera", "sensor_msgs/Image")
    data += bags.message(2, 100.0, bags.transform(0, "base_link", "rear", -0.5, 0.1, 3.0))
    for k, (seconds, x, y) in enumerate(bags.drive()):
        ranges = cli.room_ranges(x - 0.5, y + 0.1, 3.0)
        data += bags.message(3, seconds + 0.03, bags.scan(seconds + 0.01, ranges, frame="rear"))
        data += bags.message(4, seconds, bags.transform(seconds, "odom", "base_link", x, y, 0.0))
        data += bags.message(5, seconds, bags.struct.pack("<f", 80.0 + k % 21))
    return bags.bag(bags.chunk(data + bags.message(6, 101.0, b"x" * 100)))


def doctor_of_several_lasers():
    """Several topics with scans are listed, not refused, and each line to type maps what it says."""
    folder = cli.fresh_folder("doctor_of_several_lasers")
    (folder / "my drive.bag").write_bytes(two_lasers())
    found = examined(folder / "my drive.bag")
    topics = {topic["name"]: topic for topic in found["topics"]}
    uses = {name: topic["use"] for name, topic in topics.items()}
    expect(uses == {"/scan": "scans", "/rear scan": "none", "/odom": "odometry", "/tf": "frames", "/tf_static": "frames",
                    "/servo": "none", "/camera": "none"}, uses)
    counts = {name: topic["messages"] for name, topic in topics.items()}
    expect(counts == {"/scan": 40, "/rear scan": 40, "/odom": 40, "/tf": 40, "/tf_static": 2, "/servo": 40, "/camera": 1}, counts)
    expect(abs(topics["/scan"]["rate_hz"] - 4.0) < 1e-9 and topics["/rear scan"]["frames"] == ["rear"], topics)
    delay = topics["/rear scan"]["receipt_after_stamp"]
    expect(delay["messages"] == 40 and abs(delay["median_s"] - 0.02) < 1e-6 and delay["high_s"] - delay["low_s"] < 1e-6, delay)
    expect(topics["/servo"]["numbers"] == {"least": 80, "most": 100}, topics["/servo"])
    frames = {link["child"]: link for link in found["frames"]}
    expect(set(frames) == {"laser", "rear", "base_link"}, frames)
    expect(frames["base_link"]["moves"] and not frames["rear"]["moves"] and frames["rear"]["static"], frames)
    expect(abs(frames["rear"]["x_m"] + 0.5) < 1e-9 and abs(frames["rear"]["yaw_rad"] - 3.0) < 1e-6, frames)
    lines = [entry["line"] for entry in found["commands"]]
    log = shlex.quote(str(folder / "my drive.bag"))
    nodding = "--crank /servo --set log.crank=tilt --set log.crank_step=1deg --set log.crank_zero=90"
    expect(lines == [f"gdtslam map {log} --topic '/rear scan' -o out", f"gdtslam map {log} --topic /scan -o out",
                     f"gdtslam map {log} --topic all -o out", f"gdtslam map {log} --topic '/rear scan' {nodding} -o out"], lines)
    scans = [types_here(line, folder)["scans"] for line in lines[:3]]
    expect(scans == [40, 40, 80], scans)
    text = command("doctor", folder / "my drive.bag").stdout
    expect("not used: map wants --topic to choose" in text and "base_link > rear" in text and lines[2] in text, text)
    chosen = examined(folder / "my drive.bag", "--topic", "/rear scan", "--mount", "1m,0,0", "--odom", "tf")
    expect([laser["mount"] for laser in chosen["lasers"]] == ["stated"] and chosen["odometry"]["topic"] == "/tf", chosen)
    expect(chosen["commands"][0]["line"] == f"gdtslam map {log} --topic '/rear scan' --mount 1m,0,0 --odom tf -o out", chosen["commands"])
    examined(folder / "my drive.bag", "--crank", "/servo", "--set", "log.crank=tilt", "--set", "log.crank_step=1deg")

    found = examined(folder / "my drive.bag", "--topic", "all")
    expect(found["scans"] == 80 and abs(found["median_step_s"] - 0.25) < 1e-9 and found["backward_stamps"]["count"] == 1, found)
    expect(not any(words in text for text in found["suggestions"] for words in ("moves on the robot", "beams")), found["suggestions"])
    places = [(laser["scans"], round(laser["x_m"], 6), laser["changes"]) for laser in found["lasers_on_robot"]]
    expect(sorted(places) == [(40, -0.5, 0), (40, 0, 0)], places)
    text = command("doctor", folder / "my drive.bag", "--topic", "all").stdout
    for k, laser in enumerate(found["lasers"]):
        place = f"{found['lasers_on_robot'][k]['x_m']:.3f} m ahead"
        expect(any(line.startswith(f"laser {k}  ") and laser["topic"] in line and place in line for line in text.splitlines()), text)


def table_of_two_lasers(rear_x=lambda k: -0.3):
    """Back to back, each ten times a second and 5 ms apart, of different beams; the odometry once for both."""
    rows = ["stamp,laser,laser_x,laser_y,laser_theta,angle_min,angle_increment,x,y,theta,ranges"]
    for k in range(200):
        for laser, mount, beams in ((0, "0.3,0,0", 180), (1, f"{rear_x(k)},0,3.14159265", 120)):
            ranges = " ".join(f"{2 + 0.01 * beam:.2f}" for beam in range(beams))
            rows.append(f"{0.1 * k + 0.005 * laser:.3f},{laser},{mount},-1.5,0.02,{0.05 * k:.3f},0,0,{ranges}")
    return "\n".join(rows) + "\n"


def expect_two_lasers(folder):
    (folder / "two.csv").write_text(table_of_two_lasers())
    found = examined(folder / "two.csv")
    expect(abs(found["median_step_s"] - 0.1) < 1e-9 and found["still_steps"] == 0 and found["suggestions"] == [], found)
    expect([(laser["laser"], laser["scans"], laser["x_m"], laser["changes"]) for laser in found["lasers_on_robot"]] ==
           [(0, 200, 0.3, 0), (1, 200, -0.3, 0)], found["lasers_on_robot"])
    text = command("doctor", folder / "two.csv").stdout
    for line in ("scans            400 of 2 lasers in 19.9 s, 10.0 Hz a laser (median step 0.100 s)",
                 "standing still   0 steps without any motion of the odometry",
                 "laser 0          200 scans", "laser on robot   0.300 m ahead, 0.000 m left, 0.00 deg",
                 "laser 1          200 scans", "laser on robot   -0.300 m ahead, 0.000 m left, 180.00 deg"):
        expect(line in text.splitlines(), f"{line}: {text}")
    expect("moves on the robot" not in text and "one sensor only" not in text, text)
    (folder / "two.csv").write_text(table_of_two_lasers(lambda k: -0.3 if k < 150 else -0.4))
    found = examined(folder / "two.csv")
    expect([laser["changes"] for laser in found["lasers_on_robot"]] == [0, 50], found["lasers_on_robot"])
    expect(len(found["suggestions"]) == 1 and found["suggestions"][0].startswith("laser 1 moves on the robot"), found["suggestions"])
    rear = [row for row in table_of_two_lasers().splitlines() if row.split(",")[1] != "0"]
    (folder / "rear.csv").write_text("\n".join(rear) + "\n")
    found = examined(folder / "rear.csv")
    expect([laser["x_m"] for laser in found["lasers_on_robot"]] == [-0.3], found)
    lines = command("doctor", folder / "rear.csv").stdout.splitlines()
    expect("scans            200 in 19.9 s, 10.0 Hz (median step 0.100 s)" in lines, lines)
    expect("laser on robot   -0.300 m ahead, 0.000 m left, 180.00 deg" in lines and not any(line.startswith("laser 1") for line in lines), lines)


def doctor_of_hostile_names():
    """Names of topics, frames and files that would add lines of their own, or words to the line to type."""
    folder = cli.fresh_folder("doctor_of_hostile_names")
    name, frame = "/a\n-> rm -rf '/$HOME'\x1b[2J", "b\n-> c"
    data = bags.connection(0, name, bags.SCAN) + bags.connection(1, "/scan", bags.SCAN)
    for seconds, x, y in bags.drive():
        data += bags.message(0, seconds, bags.scan(seconds, cli.room_ranges(x, y, 0.0), frame=frame))
        data += bags.message(1, seconds, bags.scan(seconds, cli.room_ranges(x, y, 0.0)))
    log = folder / "it's $(a) log.bag"
    log.write_bytes(bags.bag(bags.chunk(data)))
    text = command("doctor", log).stdout
    expect("\x1b" not in text and not any(line.startswith("-> rm") or line == "-> c" for line in text.splitlines()), text)
    lines = [entry["line"] for entry in examined(log)["commands"]]
    expect(len(lines) == 3 and all("\n" not in line and "\x1b" not in line for line in lines), lines)
    words = subprocess.run(["bash", "-c", f"printf '%s\\0' {lines[0]}"], capture_output=True, text=True, check=True).stdout
    expect(words.split("\0") == ["gdtslam", "map", str(log), "--topic", name, "-o", "out", ""], words)


def doctor_without_scans():
    """A recording without scans is told to hold what it holds; a cut one gives what it has."""
    folder = cli.fresh_folder("doctor_without_scans")
    content = bags.connection(0, "/camera", "sensor_msgs/Image") + bags.message(0, 1.0, b"x") + bags.message(0, 2.0, b"x")
    (folder / "a.bag").write_bytes(bags.bag(bags.chunk(content)))
    found = examined(folder / "a.bag", code=65)
    expect([(topic["name"], topic["messages"]) for topic in found["topics"]] == [("/camera", 2)] and found["commands"] == [], found)
    complete = bags.bag(bags.chunk(bags.drive_records()))
    (folder / "cut.bag").write_bytes(complete[: len(complete) // 2])
    found = examined(folder / "cut.bag")
    expect(found["warnings"]["cut bag"]["count"] == 1 and 0 < found["scans"] < 40, found)
    expect({topic["name"] for topic in found["topics"]} == {"/scan", "/odom", "/tf_static"}, found["topics"])


def doctor_of_text_logs():
    """Kinds of lines, topics that a text log has none of, and several lasers in one."""
    folder = cli.fresh_folder("doctor_of_text_logs")
    line = cli.flaser(cli.room_ranges(2.0, 1.5, 0.0), (0, 0, 0), (0, 0, 0), 1.0)
    line = line if line.endswith("\n") else line + "\n"
    (folder / "a.log").write_text("# a comment\nPARAM a 1\n" + 3 * line + 2 * "SYNC 1 2\n")
    found = examined(folder / "a.log")
    expect(found["format"] == "CARMEN", found)
    expect(found["lines"] == [{"kind": "PARAM", "count": 1, "read": True}, {"kind": "FLASER", "count": 3, "read": True},
                              {"kind": "SYNC", "count": 2, "read": False}], found["lines"])
    expect([entry["line"] for entry in found["commands"]] == [f"gdtslam map {folder}/a.log -o out"], found["commands"])
    (folder / "a.jsonl").write_text('{"stamp":1,"odom":[0,0,0]}\n{"stamp":2,"angle_min":0,"angle_increment":0.01,"ranges":['
                                    + ",".join(str(1 + 0.01 * k) for k in range(50)) + "]}\n")
    found = examined(folder / "a.jsonl")
    expect(found["format"] == "JSON lines" and [(kind["kind"], kind["count"]) for kind in found["lines"]] ==
           [("odometry", 1), ("scans", 1)], found["lines"])
    for arguments, says in ((["--topic", "/scan"], "leave out --topic"), (["--odom", "tf"], "leave out --odom"),
                            (["--crank", "/a"], "leave out --crank"), (["--mount", "/a=0,0,0"], "leave out the name in --mount")):
        for log in ("a.log", "a.jsonl"):
            for words in (["doctor", folder / log], ["map", folder / log, "-o", folder / "run"]):
                process = command(*words, *arguments)
                expect_exit(process, 2)
                cli.one_error_line(process.stderr)
                expect(log in process.stderr and says in process.stderr, process.stderr)
    expect_exit(command("doctor", folder / "a.log", "--mount", "0.2m,0,0"), 0)
    expect_two_lasers(folder)


def doctor_of_a_nodding_recording():
    """A linkage lies beside it: map without a crank says so, and the first line to type maps in 3D, by the crank's ticks."""
    folder = cli.fresh_folder("doctor_of_a_nodding_recording")
    expect_exit(command("simulate", "three-boxes", "-o", folder / "tb.mcap", "--rate", 10, "-q"), 0)
    process = command("map", folder / "tb.mcap", "-o", folder / "flat")
    expect_exit(process, 0)
    expect("tb.linkage.yaml lies beside the log" in process.stderr and "--crank NAME" in process.stderr, process.stderr)
    found = examined(folder / "tb.mcap")
    lines = [entry["line"] for entry in found["commands"]]
    log = folder / "tb.mcap"
    expect(lines == [f"gdtslam map {log} --crank /crank -o out", f"gdtslam map {log} -o out"], lines)
    report = types_here(lines[0], folder)
    expect(report["nodding"] and (folder / "out/cloud.ply").is_file(), report.get("nodding"))
    expect("lies beside" not in command("map", log, "--crank", "/crank", "-o", folder / "again").stderr, "a crank is there")
    (folder / "tb.linkage.yaml").unlink()
    lines = [entry["line"] for entry in examined(log)["commands"]]
    expect(lines == [f"gdtslam map {log} -o out", f"gdtslam map {log} --crank /crank -o out"], lines)


def counts_of_bag(data):
    """Messages by topic of a ROS 1 bag, by the page of its format; its index is not looked at, one states wrong lengths."""
    cursor, topics, counts = Bytes(data, 13), {}, collections.Counter()
    while cursor.left():
        header = Bytes(cursor.block())
        fields = {}
        while header.left():
            name, value = header.block().split(b"=", 1)
            fields[name] = value
        if fields[b"op"] == b"\x04":
            cursor.at += 4 + 12 * whole(fields[b"count"])
            continue
        content = cursor.block()
        if fields[b"op"] != b"\x05":
            continue
        inner = Bytes(bags.bz2.decompress(content) if fields[b"compression"] == b"bz2" else content)
        while inner.left():
            about, _ = bag_record(inner)
            if about["op"] == b"\x07":
                topics[about["conn"]] = about["topic"].decode()
            else:
                counts[about["conn"]] += 1
    return {topics[number]: count for number, count in counts.items()}


def counts_of_database(file):
    with sqlite3.connect(f"file:{file}?mode=ro", uri=True) as database:
        return dict(database.execute("SELECT name, count(*) FROM messages JOIN topics ON topics.id = topic_id GROUP BY name"))


def doctor_of_real_bags():
    """Every message of the five public bags is counted, each by its topic; the line to type maps them."""
    if not REAL.is_dir():
        if os.environ.get("CI") == "true" and REAL.parent.is_dir():
            cli.expect(False, f"{REAL} is not there")
        cli.skip(f"NOTHING WAS TESTED: {REAL} is not there; set GDTSLAM_DATA")
    folder = cli.fresh_folder("doctor_of_real_bags")
    logs = []
    for packed in sorted(REAL.glob("*.bag.gz")):
        logs.append((packed, counts_of_bag(gzip.decompress(packed.read_bytes()))))
    for packed in sorted(REAL.glob("*/*.db3.gz")):
        place = folder / packed.parent.name
        place.mkdir()
        shutil.copy(packed.parent / "metadata.yaml", place)
        (place / packed.stem).write_bytes(gzip.decompress(packed.read_bytes()))
        logs.append((place, counts_of_database(place / packed.stem)))
    expect(len(logs) == 5, logs)
    for log, counts in logs:
        found = examined(log)
        expect({topic["name"]: topic["messages"] for topic in found["topics"]} == counts, f"{log}: {found['topics']} {counts}")
        expect(found["scans"] == counts["/scan"], found["scans"])
        names = [topic["name"] for topic in found["topics"] if topic["use"] == "scans"]
        expect(names == ["/scan"] and found["commands"][0]["line"] == f"gdtslam map {log} -o out", found["commands"])
        clock = next(topic for topic in found["topics"] if topic["name"] == "/scan")["receipt_after_stamp"]
        is_other = "tilt" in str(log)  # stamped by a microcontroller
        expect((abs(clock["median_s"]) > 1e9) == is_other, clock)
        expect(any("log.crank=tilt" in entry["line"] for entry in found["commands"]) == is_other, found["commands"])
