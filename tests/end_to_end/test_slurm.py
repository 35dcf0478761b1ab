"""A campaign through Slurm on one machine: two workers, a job and the controller killed, the same bytes as here."""

import os
import shutil
import signal
import socket
import subprocess
import sys
import time
from contextlib import suppress
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
NEEDED = ("munged", "slurmctld", "slurmd", "sbatch", "srun", "squeue", "scontrol")
#: chunks of the campaign: more than 40, so that a job of some chunks may be killed and others are still to come
CHUNKS, DRAWS = 42, 20
#: seconds after which a controller has written down a job that it took
SAVED = 8
#: seconds that all of it may take; a job that hangs is ended by its own limit before
BUDGET = int(os.environ.get("GAINSAY_SLURM") or 0)
CONF = """ClusterName=gainsay
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort={ports[0]}
SlurmdPort={ports[1]}
SlurmUser=root
SlurmdUser=root
AuthType=auth/munge
AuthInfo=socket={place}/munge.socket
CredType=cred/munge
StateSaveLocation={place}/state
SlurmdSpoolDir={place}/spool
SlurmctldPidFile={place}/slurmctld.pid
SlurmdPidFile={place}/slurmd.pid
SlurmctldLogFile={place}/slurmctld.log
SlurmdLogFile={place}/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
MpiDefault=none
ReturnToService=2
MinJobAge=600
KillWait=5
SchedulerParameters=batch_sched_delay=1,bf_interval=2
NodeName={host} NodeAddr=127.0.0.1 CPUs=2 RealMemory=3000 State=UNKNOWN
PartitionName=main Nodes={host} Default=YES MaxTime=INFINITE State=UP
"""


def not_checked(why: str):
    # a machine may lack Slurm or forbid its daemons: nothing was looked at then, and the summary says so
    pytest.skip(f"not checked: {why}")


def free_ports(count):
    opened = [socket.socket() for _ in range(count)]
    for one in opened:
        one.bind(("127.0.0.1", 0))
    ports = [one.getsockname()[1] for one in opened]
    for one in opened:
        one.close()
    return ports


def ended(process):
    """End a program by its own number: asked first, then killed."""
    if process.poll() is None:
        process.terminate()
        try:
            process.wait(15)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait(15)


@pytest.fixture
def limit():
    """End the test, and with it all that it started, when its time is over or the process is asked to end."""

    def over(number, frame):
        pytest.fail(f"ended by {signal.Signals(number).name}: {BUDGET} s are what it may take")

    before = {number: signal.signal(number, over) for number in (signal.SIGALRM, signal.SIGTERM)}
    signal.alarm(BUDGET)
    yield
    signal.alarm(0)
    for number, handler in before.items():
        signal.signal(number, handler)


class Cluster:
    """munged, slurmctld and slurmd of this test alone; programs are ended by their own process numbers."""

    def __init__(self, place: Path) -> None:
        self.place, self.running = place, {}
        for folder in ("state", "spool"):
            (place / folder).mkdir()
        key = place / "munge.key"
        key.write_bytes(os.urandom(1024))
        key.chmod(0o400)
        host = socket.gethostname().partition(".")[0]
        (place / "slurm.conf").write_text(CONF.format(host=host, ports=free_ports(2), place=place))
        self.env = {**os.environ, "SLURM_CONF": str(place / "slurm.conf")}

    def start(self, name, *command):
        with (self.place / f"{name}.out").open("ab") as said:
            # in a session of its own: what a test runner sends to its group is not for the cluster
            self.running[name] = subprocess.Popen(
                command, env=self.env, stdout=said, stderr=said, stdin=subprocess.DEVNULL, start_new_session=True
            )

    def begin(self):
        munge = self.place
        self.start(
            "munged", "munged", "--foreground", "--force", f"--key-file={munge}/munge.key",
            f"--socket={munge}/munge.socket", f"--pid-file={munge}/munged.pid", f"--log-file={munge}/munged.log",
            f"--seed-file={munge}/munge.seed",
        )  # fmt: skip
        self.until(lambda: (munge / "munge.socket").exists(), 20, "munged gives no socket")
        self.controller()
        self.start("slurmd", "slurmd", "-D")
        self.until(lambda: "idle" in self.said("sinfo", "-h", "-o", "%T"), 60, "the node does not come up")

    def controller(self):
        self.start("slurmctld", "slurmctld", "-D")
        self.until(lambda: "UP" in self.said("scontrol", "ping"), 60, "slurmctld does not answer")

    def said(self, *command):
        return subprocess.run(command, env=self.env, capture_output=True, text=True, timeout=60).stdout

    def until(self, holds, seconds, why):
        end = time.monotonic() + seconds
        while not holds():
            dead = [name for name, process in self.running.items() if process.poll() is not None]
            if dead or time.monotonic() > end:
                logs = [line for name in self.running for line in self.log(name)]
                not_checked(f"{why}{', ended: ' + ', '.join(dead) if dead else ''}: {' | '.join(logs)[-300:]}")
            time.sleep(0.2)

    def log(self, name):
        files = (self.place / f"{name}.log", self.place / f"{name}.out")
        return [line for file in files if file.is_file() for line in file.read_text(errors="replace").splitlines()[-3:]]

    def kill(self, name):
        process = self.running.pop(name)
        process.send_signal(signal.SIGKILL)
        process.wait(30)

    def end(self):
        for name in ("slurmd", "slurmctld", "munged"):
            process = self.running.pop(name, None)
            if process is not None:
                ended(process)
        # jobs are children of slurmd's helpers, which outlive it: those that work in this folder are ours
        for place in Path("/proc").glob("[0-9]*/cwd"):
            with suppress(OSError):
                if place.readlink().is_relative_to(self.place.parent):
                    os.kill(int(place.parent.name), signal.SIGKILL)


@pytest.fixture
def cluster(limit, tmp_path):
    if not BUDGET:
        not_checked("GAINSAY_SLURM=SECONDS runs it for so long at most, as `make slurm` does")
    missing = [name for name in NEEDED if shutil.which(name) is None]
    if missing:
        not_checked(f"no {', '.join(missing)} on this machine")
    if os.geteuid() != 0:
        not_checked("Slurm on one machine needs the superuser")
    place = tmp_path / "slurm"
    place.mkdir()
    made = Cluster(place)
    try:
        made.begin()
        yield made
    finally:
        with suppress(subprocess.TimeoutExpired):
            made.said("scancel", "--user=root")
        made.end()


@pytest.fixture
def plugin(tmp_path):
    """The executor of Snakemake beside the environment of this project, not in it."""
    uv = Path(sys.executable).parent / "uv"
    file = ROOT / "workflow/profiles/slurm/requirements.txt"
    command = [uv, "pip", "install", "--quiet", "--require-hashes", "--no-deps", "--python", sys.executable]
    done = subprocess.run([*command, "--target", tmp_path / "plugin", "-r", file], capture_output=True, text=True)
    if done.returncode:
        not_checked(f"the executor cannot be installed: {done.stderr.strip()[-200:]}")
    return tmp_path / "plugin"


MODULE = '''"""A campaign of a toy."""

import time

from gainsay.campaigns.draws import counted_draws


def below(case, block):
    time.sleep(0.05)
    return {"low": (int((block.generator().random(block.size) < 0.25).sum()), 0)}


CAMPAIGNS = {"luck": counted_draws(("factor",), "below", {"low": "a quarter"}, below)}
'''


def project_of(place: Path, project, draws: int) -> Path:
    """A project with one campaign of 840 draws, so many a chunk."""
    shutil.copytree(project.root, place)
    (place / "Snakefile").write_text('configfile: "config.yaml"\n\n\ninclude: "' + str(
        ROOT / "workflow/gainsay/rules/gainsay.smk") + '"\n\n\nrule all:\n    input:\n        WANTED,\n')  # fmt: skip
    (place / "config.yaml").write_text('papers: ""\nnumeric_threads: 1\n')
    (place / "papers/__init__.py").write_text("")
    (place / "papers/toy/__init__.py").write_text("")
    (place / "papers/toy/campaigns.py").write_text(MODULE)
    (place / "papers/toy/campaigns.csv").write_text(
        "name,kind,inputs,resolution,seed,block,chunk,claim,question\n"
        f"luck,draws,factor=0..1,{DRAWS * CHUNKS},7,10,{draws},,how often\n"
    )
    return place


def results(place: Path) -> dict[str, bytes]:
    folder = place / "results/toy/campaigns"
    return {ending: (folder / f"luck.{ending}").read_bytes() for ending in ("json", "parquet", "svg")}


def chunks(place: Path) -> int:
    return len(list((place / "results/toy/campaigns/luck").glob("*/chunk-*.parquet")))


@pytest.mark.slow
def test_a_campaign_through_slurm_is_that_of_this_machine_to_the_byte(cluster, plugin, project, tmp_path):
    snakemake = [sys.executable, "-m", "snakemake", "campaigns"]
    # in four large chunks here, in many small ones there
    here = project_of(tmp_path / "here", project, DRAWS * CHUNKS // 4)
    done = subprocess.run([*snakemake, "--cores", "2"], cwd=here, capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stdout + done.stderr
    expected = results(here)

    there = project_of(tmp_path / "there", project, DRAWS)
    # srun of a job starts without what names the configuration: the executor takes it out of the environment
    (tmp_path / "bin").mkdir()
    srun = tmp_path / "bin/srun"
    srun.write_text(f'#!/bin/sh\nSLURM_CONF={cluster.place}/slurm.conf exec {shutil.which("srun")} "$@"\n')
    srun.chmod(0o755)
    before = {"PYTHONPATH": plugin, "PATH": tmp_path / "bin"}
    env = {**cluster.env, **{name: f"{first}:{os.environ.get(name, '')}" for name, first in before.items()}}
    command = [
        *snakemake, "--profile", str(ROOT / "workflow/profiles/slurm"), "--jobs", "2", "--group-components", "chunks=3",
        "--slurm-no-account", "--slurm-init-seconds-before-status-checks", "2", "--seconds-between-status-checks", "2",
        "--default-resources", "slurm_partition=main", "mem_mb=500", "runtime=10",
        # minutes a chunk: a job that hangs, its controller being dead, ends by this and is done again
        "--set-resources", "campaign_chunk:runtime=2",
    ]  # fmt: skip
    with (tmp_path / "slurm.said").open("w") as said:
        run = subprocess.Popen(command, cwd=there, env=env, stdout=said, stderr=said, start_new_session=True)
        try:
            killed = interrupt(cluster, run, there)
            assert run.wait() == 0, (tmp_path / "slurm.said").read_text()[-3000:]
        finally:
            ended(run)
    assert killed, "nothing was killed: the campaign was over before"
    assert results(there) == expected


def interrupt(cluster: Cluster, run: subprocess.Popen, there: Path) -> bool:
    """Kill one job while chunks are computed; once it is submitted again kill the controller, and start it again."""

    def running() -> set[str]:
        return set(cluster.said("squeue", "-h", "-t", "R", "-o", "%i").split())

    while chunks(there) < 2 and run.poll() is None:
        time.sleep(0.2)
    before = running()
    if run.poll() is not None or not before:
        return False
    cluster.said("scancel", "--signal=KILL", "--full", min(before))
    while not running() - before and run.poll() is None:
        time.sleep(0.5)
    # a controller writes down what it knows within 5 s: a job that it took in the last ones would be lost with it
    time.sleep(SAVED)
    cluster.kill("slurmctld")
    time.sleep(3)
    cluster.controller()
    return run.poll() is None and chunks(there) < CHUNKS
