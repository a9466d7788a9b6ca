"""A Dask cluster of processes on this machine: a scheduler, workers with folders of their own, and a wire to cut."""

import os
import socket
import subprocess
import sys
import threading
import time
from pathlib import Path

from distributed import Client

# Of the environment, workers get no more than they need: nothing by which they could find what was not sent.
KEPT = ("PATH", "HOME", "LANG", "TMPDIR", "VIRTUAL_ENV")


class Cluster:
    def __init__(self, folder):
        self.folder = folder
        self.processes = {}
        self.port = free_port()
        self.address = f"tcp://127.0.0.1:{self.port}"
        self.start("scheduler", "dask_scheduler", "--host", "127.0.0.1", "--port", self.port, "--no-dashboard")

    def start(self, name, module, *words, path=None, before=None, wrapper=()):
        folder = self.folder / name
        folder.mkdir(exist_ok=True)
        environment = {key: os.environ[key] for key in KEPT if key in os.environ}
        environment["DASK_DISTRIBUTED__COMM__TIMEOUTS__CONNECT"] = "20s"
        if path:
            environment["PATH"] = f"{path}:{environment['PATH']}"
        with open(folder / "log.txt", "ab") as log:
            self.processes[name] = subprocess.Popen(
                [*wrapper, sys.executable, "-m", f"distributed.cli.{module}", *map(str, words)],
                cwd=folder, env=environment, stdout=log, stderr=log, preexec_fn=before,
            )

    def worker(self, name, **options):
        """A worker of one thread, in a process and a folder of its own."""
        self.start(name, "dask_worker", self.address, "--nthreads", 1, "--no-nanny", "--no-dashboard", "--host", "127.0.0.1",
                   "--name", name, "--local-directory", self.folder / name, "--death-timeout", 60, **options)

    def ready(self, *names):
        """Waits until the scheduler has these workers."""
        self.until(lambda there: there >= set(names), f"not all of {names} are there")

    def kill(self, name):
        """Kills a worker, and waits until the scheduler knows that it is gone."""
        self.end(name)
        self.until(lambda there: name not in there, f"{name} is still there")

    def until(self, happened, otherwise, seconds=60):
        end = time.monotonic() + seconds
        with Client(self.address, set_as_default=False, timeout=seconds) as client:
            while not happened({worker["name"] for worker in client.scheduler_info(-1)["workers"].values()}):
                assert time.monotonic() < end, f"{otherwise}\n{self.logs()}"
                time.sleep(0.05)

    def end(self, name):
        process = self.processes.pop(name)
        process.kill()
        process.wait()

    def close(self):
        for name in list(self.processes):
            self.end(name)

    def logs(self):
        logs = self.folder.glob("*/log.txt")
        return "\n".join(f"--- {log}\n{log.read_text(errors='replace')[-3000:]}" for log in logs)


class Gate:
    """A program that does all parts at once but those from some step on, which wait until the gate is opened.

    So what happens to parts that are at work happens to them, however fast or slow the machine is.
    """

    def __init__(self, folder, binary, first):
        self.shut, self.waiting = folder / "shut", folder / "waiting"
        self.shut.touch()
        self.waiting.mkdir()
        self.program = folder / "gate"
        # A part whose worker is gone does not wait for it.
        self.program.write_text(
            "#!/bin/sh\n"
            f'from=${{2#--only=}}; from=${{from%%..*}}\n'
            f'case "$2" in --only=*) if [ "$from" -ge {first} ]; then\n'
            f'  : >"{self.waiting}/$PPID"\n'
            f'  while [ -e "{self.shut}" ]; do kill -0 $PPID || exit 1; sleep 0.05; done\n'
            "fi ;; esac\n"
            f'exec "{binary}" "$@"\n')
        self.program.chmod(0o755)

    def held(self, workers, seconds=60):
        """Waits until each of so many workers has a part at the gate."""
        end = time.monotonic() + seconds
        while len(list(self.waiting.iterdir())) < workers:
            assert time.monotonic() < end, f"no {workers} workers wait"
            time.sleep(0.01)

    def open(self):
        self.shut.unlink()


class Wire:
    """A port that leads to another; the wire between can be held still for a while, or cut."""

    def __init__(self, port):
        self.to = port
        self.flows = threading.Event()
        self.flows.set()
        self.pairs = []
        self.lock = threading.Lock()
        self.listen()
        self.address = f"tcp://127.0.0.1:{self.port}"

    def listen(self):
        self.server = socket.socket()
        self.server.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        self.server.bind(("127.0.0.1", getattr(self, "port", 0)))
        self.port = self.server.getsockname()[1]
        self.server.listen(64)
        threading.Thread(target=self.accept, args=(self.server,), daemon=True).start()

    def accept(self, server):
        while True:
            try:
                near, _ = server.accept()
                far = socket.create_connection(("127.0.0.1", self.to))
            except OSError:
                return
            with self.lock:
                self.pairs.append((near, far))
            for one, other in [(near, far), (far, near)]:
                threading.Thread(target=self.carry, args=(one, other), daemon=True).start()

    def carry(self, one, other):
        try:
            while piece := one.recv(1 << 16):
                self.flows.wait()
                other.sendall(piece)
        except OSError:
            pass
        for end in (one, other):
            try:
                end.shutdown(socket.SHUT_RDWR)
            except OSError:
                pass

    def hold(self, seconds):
        """Nothing goes through for a while, and nothing is lost."""
        self.flows.clear()
        time.sleep(seconds)
        self.flows.set()

    def cut(self, seconds):
        """All connections end, and for a while there are no new ones."""
        self.server.shutdown(socket.SHUT_RDWR)
        self.server.close()
        with self.lock:
            for pair in self.pairs:
                for end in pair:
                    try:
                        end.shutdown(socket.SHUT_RDWR)
                    except OSError:
                        pass
            self.pairs.clear()
        time.sleep(seconds)
        self.listen()


def free_port():
    with socket.socket() as one:
        one.bind(("127.0.0.1", 0))
        return one.getsockname()[1]


class Run:
    """The farm's client at work, in a folder."""

    def __init__(self, folder, scheduler, *words):
        farm = Path(__file__).resolve().parents[2] / "examples" / "farm" / "farm.py"
        self.folder = folder
        self.command = [sys.executable, str(farm), *map(str, words), "--scheduler", scheduler, "--table", "table.json"]
        self.process = subprocess.Popen(self.command, cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)

    def when(self, pattern, count, seconds=300):
        """Waits until so many files have come back."""
        end = time.monotonic() + seconds
        while len(list(self.folder.glob(pattern))) < count:
            assert self.process.poll() is None, self.ended()
            assert time.monotonic() < end, f"no {count} files"
            time.sleep(0.005)

    def ended(self, seconds=600):
        """Exit status, table and messages."""
        out, err = self.process.communicate(timeout=seconds)
        return self.process.returncode, out, err
