"""scenes/dataset.sbatch under a real Slurm of one node, which loses that node: what the tasks make together is, to the byte,
what one run makes. `slurm_test.py SIMVIS_RUN`; exit status 77: the machine lacks what Slurm needs, and the test is skipped."""
import contextlib
import os
import pathlib
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
SKIPPED = 77
FRAMES, SHARDS = 1000, 10
REPEATED = 9  # the task that the user stops, and starts again by its number
# A task lasts FRAMES / 15 Hz / SPEED = 1.7 s at least, so that the node is lost while tasks run.
SPEED = 40
SCAN = ["scenes/marvin/marvin.xml", "--trajectory", "scenes/marvin/drive.csv", "--frames", str(FRAMES), "--method",
        "raycast", "--sensor", "FRONT_SCANNER", "--sensor", "REAR_SCANNER"]
# Longer than anything takes on a busy machine; nothing waits for a time.
PATIENCE_S = 200


class Lacking(Exception):
    """What the machine lacks."""


def wait_for(what, condition):
    """Returns what `condition` returns once that is true."""
    end = time.monotonic() + PATIENCE_S
    while time.monotonic() < end:
        if result := condition():
            return result
        time.sleep(0.02)
    raise AssertionError(f"{what}: not within {PATIENCE_S} s")


def free_ports(count):
    with contextlib.ExitStack() as sockets:
        found = [sockets.enter_context(socket.socket()) for _ in range(count)]
        for each in found:
            each.bind(("127.0.0.1", 0))
        return [each.getsockname()[1] for each in found]


class Cluster:
    """Slurm's daemons with all of their files in one folder. The node says that it has four processors, so that two tasks of
    two run at once on any machine."""

    def __init__(self, folder):
        self.folder = folder
        self.node = socket.gethostname().split(".")[0]
        self.environment = dict(os.environ, SLURM_CONF=str(folder / "slurm.conf"))
        self.daemons = {}
        for name in ("state", "spool", "munge"):
            (folder / name).mkdir(mode=0o700)
        key = folder / "munge/key"
        key.write_bytes(os.urandom(1024))
        key.chmod(0o400)
        user = subprocess.check_output(["id", "-un"], text=True).strip()
        controller_port, node_port = free_ports(2)
        # No plug-in below uses control groups. Without this line slurmd looks for those that systemd mounts, and ends in a
        # container that has none.
        (folder / "cgroup.conf").write_text("CgroupPlugin=cgroup/v1\n")
        (folder / "slurm.conf").write_text(f"""\
ClusterName=simvis
SlurmctldHost={self.node}(127.0.0.1)
SlurmctldPort={controller_port}
SlurmdPort={node_port}
SlurmUser={user}
SlurmdUser={user}
AuthType=auth/munge
AuthInfo=socket={folder}/munge/socket
CredType=cred/munge
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.pid
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
MpiDefault=none
ReturnToService=2
SchedulerType=sched/builtin
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SlurmdParameters=config_overrides
NodeName={self.node} NodeAddr=127.0.0.1 CPUs=4 State=UNKNOWN
PartitionName=all Nodes=ALL Default=YES MaxTime=INFINITE State=UP
""")

    def start(self, name, *command):
        log = open(self.folder / f"{name}.log", "ab")
        self.daemons[name] = subprocess.Popen(command, env=self.environment, stdout=log, stderr=log,
                                              start_new_session=True)

    def start_node(self):
        self.start("slurmd", "slurmd", "-D")

    def __enter__(self):
        try:
            self.start_all()
        except BaseException as error:
            self.__exit__(type(error))
            raise
        return self

    def start_all(self):
        munge = self.folder / "munge"
        self.start("munged", "munged", "--foreground", "--force", f"--key-file={munge}/key", f"--socket={munge}/socket",
                   f"--pid-file={munge}/pid", f"--log-file={munge}/log", f"--seed-file={munge}/seed")
        wait_for("munged", lambda: self.runs("munged") and (munge / "socket").exists())
        self.start("slurmctld", "slurmctld", "-D")
        self.start_node()
        wait_for("the node", lambda: self.runs("slurmctld") and self.runs("slurmd") and self.state() == "idle")

    def runs(self, name):
        """True. A daemon that ends before the cluster is there cannot run on this machine, and its log says why."""
        if self.daemons[name].poll() is not None:
            lines = (self.folder / f"{name}.log").read_text(errors="replace").splitlines()
            errors = [line for line in lines if "error" in line.lower()]
            raise Lacking(f"{name} does not run here: " + "; ".join(errors[:3] or ["its log has no error"]))
        return True

    def __exit__(self, kind, *_):
        if "slurmd" in self.daemons:
            self.lose_node()
        for daemon in self.daemons.values():
            daemon.kill()
            daemon.wait()
        if kind not in (None, Lacking):
            for name in self.daemons:
                print(f"--- {name}\n{(self.folder / f'{name}.log').read_text()[-3000:]}", file=sys.stderr)

    def run(self, *command, cwd=None):
        return subprocess.run(command, env=self.environment, cwd=cwd, text=True, capture_output=True)

    def state(self):
        return self.run("sinfo", "-h", "-o", "%T").stdout.strip()

    def is_back(self):
        """Whether a node that was lost takes tasks again. Slurm refuses to resume it until its daemon has registered."""
        if self.state() in ("idle", "mixed", "allocated"):
            return True
        self.run("scontrol", "update", f"nodename={self.node}", "state=resume")
        return False

    def submit(self, folder, array, environment=None):
        """The identifier of a job array of dataset.sbatch."""
        run = subprocess.run(["sbatch", "--parsable", f"--array={array}", str(ROOT / "scenes/dataset.sbatch"), *SCAN,
                              "--real-time", str(SPEED), "--out", "out"], cwd=folder, text=True, capture_output=True,
                             env={**self.environment, **(environment or {})})
        assert run.returncode == 0, run.stderr
        return run.stdout.strip()

    def queue(self, job):
        """The states of its tasks that have not ended."""
        return self.run("squeue", "-h", "-r", "-j", job, "-o", "%K %T").stdout.split("\n")[:-1]

    def descendants(self, parent):
        found = []
        for child in subprocess.run(["pgrep", "-P", str(parent)], text=True, capture_output=True).stdout.split():
            found += [int(child), *self.descendants(child)]
        return found

    def lose_node(self):
        """As when its power fails: its daemon and all tasks are gone at once."""
        steps = subprocess.run(["pgrep", "-f", "slurmstepd: .*"], text=True, capture_output=True).stdout.split()
        own = [int(step) for step in steps if str(self.folder) in self.environment_of(step)]
        for process in [self.daemons["slurmd"].pid, *own, *(each for step in own for each in self.descendants(step))]:
            with contextlib.suppress(ProcessLookupError):
                os.kill(process, signal.SIGKILL)
        self.daemons["slurmd"].wait()

    @staticmethod
    def environment_of(process):
        try:
            return pathlib.Path(f"/proc/{process}/environ").read_text(errors="replace")
        except OSError:
            return ""


def status(folder, shard):
    try:
        text = (folder / f"out/run-{shard}-of-{SHARDS}.json").read_text()
    except OSError:
        return "not begun"
    return text.split('"status": "')[1].split('"')[0]


def running(folder):
    return [shard for shard in range(SHARDS) if status(folder, shard) == "running"]


def join(folder):
    """The tables of all shards, as docs/command-line.md joins them."""
    for first in folder.glob(f"*-0-of-{SHARDS}.csv"):
        table = first.name.split("-0-of-")[0]
        shards = [(folder / f"{table}-{shard}-of-{SHARDS}.csv").read_text().splitlines(True) for shard in range(SHARDS)]
        rows = sorted((row for rows in shards for row in rows[1:]), key=lambda row: int(row.split(",")[0]))
        yield f"{table}.csv", shards[0][0] + "".join(rows)


def make_dataset(cluster, folder):
    job = cluster.submit(folder, f"0-{SHARDS - 1}")
    wait_for("a task that writes", lambda: running(folder))
    cluster.lose_node()
    lost = running(folder)
    assert lost, "no task was under way when the node was lost"
    cluster.run("scancel", f"{job}_{REPEATED}")
    cluster.run("scontrol", "update", f"nodename={cluster.node}", "state=down", "reason=lost")
    cluster.start_node()
    # Slurm holds tasks of a lost node back for two minutes; an administrator may say that they start now.
    wait_for("the tasks again", lambda: cluster.run("scontrol", "update", f"jobid={job}", "starttime=now").returncode == 0)
    wait_for("the node again", cluster.is_back)
    wait_for("the end of the array", lambda: not cluster.queue(job))
    missing = [shard for shard in range(SHARDS) if status(folder, shard) != "complete"]
    assert missing == [REPEATED], f"shards that are not complete: {missing}"
    again = cluster.submit(folder, str(REPEATED), {"SHARDS": str(SHARDS)})
    wait_for("the task that is started again", lambda: not cluster.queue(again))
    assert status(folder, REPEATED) == "complete"
    return lost


def main(program):
    needed = ("pgrep", "munged", "slurmctld", "slurmd", "sbatch", "squeue", "sinfo", "scontrol", "scancel")
    for name in needed:
        if shutil.which(name, path=os.environ["PATH"] + ":/usr/sbin") is None:
            print(f"skipped: {name} is not installed (Debian's {'procps' if name == 'pgrep' else 'slurm-wlm'})")
            return SKIPPED
    os.environ["PATH"] += ":/usr/sbin"
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        (folder / "build/release/bin").mkdir(parents=True)
        (folder / "build/release/bin/simvis-run").symlink_to(program)
        (folder / "scenes").symlink_to(ROOT / "scenes")
        try:
            with Cluster(folder) as cluster:
                lost = make_dataset(cluster, folder)
        except Lacking as error:
            print(f"skipped: {error}")
            return SKIPPED
        subprocess.run([program, "--quiet", *SCAN, "--out", "one"], cwd=folder, check=True)
        tables = dict(join(folder / "out"))
        expected = {file.name: file.read_text() for file in (folder / "one").glob("*.csv")}
        assert sorted(tables) == sorted(expected) and len(expected) == 4, sorted(tables)
        for table, text in expected.items():
            assert tables[table] == text, f"{table} differs from that of one run"
            assert text.count("\n") > FRAMES
        print(f"shards {lost} were lost with their node and made again; {len(expected)} tables are those of one run")
    return 0


sys.exit(main(str(pathlib.Path(sys.argv[1]).resolve())))
