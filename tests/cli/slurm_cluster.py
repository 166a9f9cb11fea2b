"""A Slurm cluster of two nodes on this host, for the tests: munged, slurmctld and the slurmd of n1 and n2, without systemd.

`with SlurmCluster() as slurm:` starts it in a folder of its own, on ports that are free, and waits until both nodes are
idle, which takes some two seconds. `slurm.environment` makes sbatch and its like speak to it. At the end, after a failure
too, every process that came from it is ended by its id: this process adopts those whose parents are gone. A test that is
killed takes the daemons with it. Several clusters may run at once."""

import contextlib
import ctypes
import getpass
import os
import pathlib
import re
import secrets
import shutil
import signal
import socket
import subprocess
import tempfile
import time

from cli_support import SLOWNESS, expect, skip

NODES = ("n1", "n2")
PROGRAMS = ("munged", "slurmctld", "slurmd", "sbatch", "squeue", "sinfo", "scontrol", "scancel")
SET_DEATH_SIGNAL = 1
SET_SUBREAPER = 36

CONFIGURATION = """\
ClusterName=gdtslam
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort={controller_port}
SlurmUser={user}
SlurmdUser={user}
AuthType=auth/munge
# A job of a lost node waits this long before it runs again.
AuthInfo=socket={folder}/munge.socket,cred_expire=5
CredType=cred/munge
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.%n.pid
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool.%n
SlurmctldLogFile={folder}/slurmctld.log
SlurmdLogFile={folder}/slurmd.%n.log
# Neither control groups nor accounts: what a container without systemd has not.
ProctrackType=proctrack/pgid
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
SlurmdParameters=config_overrides
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
SchedulerParameters=batch_sched_delay=0,sched_interval=1
ReturnToService=2
SlurmdTimeout=5
KillWait=2
MailProg=/bin/true
PartitionName=main Nodes={nodes} Default=YES MaxTime=INFINITE State=UP
"""


def missing_programs():
    path = os.pathsep.join([os.environ.get("PATH", ""), "/usr/sbin", "/sbin"])
    return [program for program in PROGRAMS if not shutil.which(program, path=path)]


def require_slurm():
    """Skips a scenario where there is no Slurm; fails it when GDTSLAM_REQUIRE_PROGRAMS=1."""
    missing = missing_programs()
    if missing:
        expect(os.environ.get("GDTSLAM_REQUIRE_PROGRAMS") != "1", f"GDTSLAM_REQUIRE_PROGRAMS=1 and not there: {missing}")
        skip(f"there is no Slurm here: {', '.join(missing)}")


def process_control(option, value):
    ctypes.CDLL(None, use_errno=True).prctl(option, value, 0, 0, 0)


def parents():
    """The parent of every process."""
    found = {}
    for entry in pathlib.Path("/proc").iterdir():
        if entry.name.isdigit():
            with contextlib.suppress(OSError):
                found[int(entry.name)] = int((entry / "stat").read_text().rpartition(")")[2].split()[1])
    return found


def descendants(ancestor):
    """The ids of all processes below one, children before parents."""
    children = {}
    for process, parent in parents().items():
        children.setdefault(parent, []).append(process)
    found = [ancestor]
    for process in found:
        found += children.get(process, [])
    return found[:0:-1]


def end_process(process, how=signal.SIGKILL):
    with contextlib.suppress(ProcessLookupError):
        os.kill(process, how)


def reap(others=()):
    """Lets go of the children that have ended, but for `others`: to Slurm, a job of which one is left has not ended."""
    mine = os.getpid()
    for process, parent in parents().items():
        if parent == mine and process not in others:
            with contextlib.suppress(ChildProcessError):
                os.waitpid(process, os.WNOHANG)


def free_ports(number):
    """Ports that nobody listens at now, all different."""
    with contextlib.ExitStack() as stack:
        sockets = [stack.enter_context(socket.socket()) for _ in range(number)]
        for one in sockets:
            one.bind(("127.0.0.1", 0))
        return [one.getsockname()[1] for one in sockets]


class SlurmCluster:
    def __init__(self):
        require_slurm()
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="gdtslam-slurm-"))  # short: names of sockets end at 107 bytes
        self.environment = {**os.environ, "SLURM_CONF": str(self.folder / "slurm.conf")}
        self.environment["PATH"] = os.pathsep.join([self.environment.get("PATH", ""), "/usr/sbin", "/sbin"])
        self.daemons = {}
        self.foreign = set()

    def __enter__(self):
        process_control(SET_SUBREAPER, 1)
        self.foreign = set(descendants(os.getpid()))
        try:
            self.start()
        except BaseException:
            self.close()
            raise
        return self

    def __exit__(self, kind, *_):
        if kind is not None:
            self.print_logs()
        self.close()

    def start(self):
        self.write_configuration()
        self.start_daemon("munged", "munged", "--foreground", "--force", f"--key-file={self.folder}/munge.key",
                          f"--socket={self.folder}/munge.socket", f"--pid-file={self.folder}/munged.pid",
                          f"--seed-file={self.folder}/munge.seed", f"--log-file={self.folder}/munged.log", "--num-threads=2")
        self.wait_until("munged answers", (self.folder / "munge.socket").exists, 60)
        self.start_daemon("slurmctld", "slurmctld", "-D")
        for node in NODES:
            self.start_daemon(node, "slurmd", "-D", "-N", node)
        self.wait_until("both nodes are idle", lambda: self.states() == dict.fromkeys(NODES, "idle"), 60)

    def write_configuration(self):
        for name in ("state", *(f"spool.{node}" for node in NODES)):
            (self.folder / name).mkdir(mode=0o700)
        (self.folder / "munge.key").write_bytes(secrets.token_bytes(128))
        (self.folder / "munge.key").chmod(0o600)
        host = socket.gethostname().partition(".")[0]
        ports = free_ports(1 + len(NODES))
        text = CONFIGURATION.format(host=host, folder=self.folder, user=getpass.getuser(), controller_port=ports[0],
                                    nodes=",".join(NODES))
        for node, port in zip(NODES, ports[1:]):
            text += f"NodeName={node} NodeHostname={host} NodeAddr=127.0.0.1 Port={port} CPUs=1 RealMemory=64000\n"
        (self.folder / "slurm.conf").write_text(text)

    def start_daemon(self, name, *command):
        with open(self.folder / f"{name}.out", "ab") as out:
            self.daemons[name] = subprocess.Popen(
                command, env=self.environment, stdin=subprocess.DEVNULL,
                stdout=out, stderr=out, start_new_session=True,
                preexec_fn=lambda: process_control(SET_DEATH_SIGNAL, signal.SIGKILL))

    def run(self, *command):
        """Runs a program of Slurm; its standard output, and None where it fails."""
        done = subprocess.run(command, env=self.environment, capture_output=True, text=True, check=False, timeout=60)
        return done.stdout if done.returncode == 0 else None

    def states(self):
        """The state of each node, as "idle", "mixed", "allocated", "down"; with a mark at the end where it does not answer."""
        text = self.run("sinfo", "--noheader", "--Node", "--format=%N %T") or ""
        return dict(line.split() for line in text.splitlines())

    def jobs(self):
        """The jobs that wait or run, with their states: `squeue` by array task; None where slurmctld does not answer."""
        text = self.run("squeue", "--noheader", "--array", "--format=%i %T %N %r")
        return None if text is None else [line.split(maxsplit=3) for line in text.splitlines()]

    def wait_until(self, what, condition, seconds):
        end = time.monotonic() + SLOWNESS * seconds
        while not condition():
            for name, daemon in self.daemons.items():
                if daemon.poll() is not None:
                    self.print_logs()
                    expect(False, f"{name} ended while waiting until {what}")
            if time.monotonic() > end:
                self.print_logs()
                expect(False, f"not within {SLOWNESS * seconds} s: {what}; nodes {self.states()}, jobs {self.jobs()}")
            reap(self.foreign | {daemon.pid for daemon in self.daemons.values()})
            time.sleep(0.05)

    def wait_for_jobs(self, seconds=180):
        """Waits until no job waits or runs."""
        self.wait_until("all jobs have ended", lambda: self.jobs() == [], seconds)

    def print_logs(self):
        for path in sorted(self.folder.glob("*.log")):
            lines = path.read_text(errors="replace").splitlines()
            serious = [line for line in lines if re.search(r"error|fatal|requeue|DOWN|fail", line) and not re.search("Could not open|NOTE: Trying", line)]
            print(f"--- {path.name}: {len(lines)} lines", *serious[-25:], sep="\n")

    def close(self):
        """Ends every process that came from here and removes the folder."""
        end = time.monotonic() + 20
        while True:
            reap(self.foreign)
            left = [process for process in descendants(os.getpid()) if process not in self.foreign]
            if not left or time.monotonic() > end:
                break
            for process in left:
                end_process(process)
            time.sleep(0.02)
        shutil.rmtree(self.folder, ignore_errors=True)
        expect(not left, f"processes of the cluster that do not end: {left}")
