"""What happens on a worker: files are unpacked, the program does a part of the work, its files go back.

These functions travel to the workers, where nothing of the farm is installed.
"""

import hashlib
import io
import json
import os
import shutil
import subprocess
import threading
import zipfile
from collections import defaultdict
from pathlib import Path

from distributed import get_worker
from distributed.diagnostics.plugin import WorkerPlugin


class Inputs(WorkerPlugin):
    """The files of a job, on each worker that there is and on each that comes later.

    They wait in memory until the first part of the work comes, so that a worker whose disk is full is not lost.
    """

    def __init__(self, job):
        self.name = job.name
        self.version = job.version
        self.program = job.program
        self.pack = job.packed()
        self.folders = job.folders()
        self.here = os.getcwd()

    def setup(self, worker):
        self.root = Path(worker.local_directory) / self.name
        self.plan = self.root / "plan"
        self.lock = threading.Lock()
        self.locks = defaultdict(threading.Lock)
        self.ready = False

    def teardown(self, worker):
        shutil.rmtree(self.root, ignore_errors=True)

    def unpack(self):
        """Unpacks the files, once; the program, and the folder to run it in."""
        own = self.root / "program"
        below = str(self.root / "root")
        with self.lock:
            if not self.ready:
                shutil.rmtree(self.root, ignore_errors=True)
                with zipfile.ZipFile(io.BytesIO(self.pack)) as packed:
                    packed.extractall(self.root)
                for folder in self.folders:
                    os.makedirs(below + folder, exist_ok=True)
                if own.exists():
                    own.chmod(0o755)
                program = str(own) if own.exists() else self.program
                said = subprocess.run([program, "--version"], capture_output=True, text=True).stdout.split()
                if said[-1:] != [self.version]:
                    raise OSError(f"{self.program} has the version {said[-1:]}, expected {self.version}")
                self.ready = True
        return str(own) if own.exists() else self.program, below + self.here


# Errors of a machine, not of the work: another worker may do better.
OF_MACHINE = ("No space left", "File too large", "Disk quota", "Input/output error", "Cannot allocate", "Read-only file",
              "Too many open files", "Permission denied")


def work(name, command, arguments, first, end, threads):
    """Does the steps from `first` up to `end`; their files, or the trouble that this worker has."""
    worker = get_worker()
    if name not in worker.plugins:
        return {"worker": worker.address, "trouble": "the files of the job have not arrived"}
    inputs = worker.plugins[name]
    # A try that nobody waits for any more may still be at work on the same files.
    with inputs.locks[first]:
        return tried(worker, inputs, command, arguments, first, end, threads)


def tried(worker, inputs, command, arguments, first, end, threads):
    told = {"worker": worker.address, "files": [], "lines": [], "messages": []}
    written = []
    try:
        program, folder = inputs.unpack()
        threads = threads or max(1, (os.cpu_count() or 1) // worker.state.nthreads)
        words = [program, command, f"--only={first}..{end}", "--progress=json", f"--threads={threads}"]
        if inputs.plan.exists():
            words.append(f"--planned={inputs.plan}")
        words += arguments
        done = subprocess.run(words, cwd=folder, capture_output=True, stdin=subprocess.DEVNULL)
        for line in done.stderr.decode(errors="replace").splitlines():
            if line.startswith("{"):
                told["lines"].append(json.loads(line))
            else:
                told["messages"].append(line)
        files = [line for line in told["lines"] if line["file"]]
        written = [Path(folder) / line["file"] for line in files]
        failure = next((line.removeprefix("error: ") for line in told["messages"] if line.startswith("error: ")), "")
        if done.returncode < 0:
            return {**told, "trouble": f"the program was ended by signal {-done.returncode}"}
        errors = [line["error"] for line in told["lines"] if line.get("error")] + [failure]
        if done.returncode not in (0, 1) and (of_machine := [e for e in errors if any(words in e for words in OF_MACHINE)]):
            return {**told, "trouble": of_machine[0]}
        if done.returncode not in (0, 1) and command != "sweep":
            return {**told, "failure": failure or f"exit status {done.returncode}"}
        for line, place in zip(files, written):
            content = place.read_bytes() if place.exists() else b""
            if len(content) != line["bytes"]:
                return {**told, "trouble": f"{line['file']} has {len(content)} of {line['bytes']} bytes"}
            told["files"].append((line["file"], content, hashlib.sha256(content).hexdigest()))
        seen = {line["step"] for line in told["lines"]}
        if not seen.issuperset(range(first, end)):
            return {**told, "failure": failure or "the program did not say what it made"}
        return told
    except (OSError, ValueError) as error:
        return {**told, "files": [], "trouble": f"{type(error).__name__}: {error}"}
    finally:
        for place in written:
            place.unlink(missing_ok=True)
