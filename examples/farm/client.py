"""Hands parts of the work to workers, and gets back what was lost."""

import hashlib
import sys
import time
from collections import Counter, deque
from pathlib import Path

import cloudpickle
from distributed import Client, LocalCluster
from distributed.comm import CommClosedError

import job
import worker

# Parts that are handed out before others are done, for each thread of the workers: enough that none waits.
AHEAD = 2

# A worker that had trouble so often gets no more work.
STRIKES = 2

# Errors of connections and of cancelled work, all of which mean: once more.
LOST = (OSError, TimeoutError, RuntimeError)
WIRE_LOST = "connection to the scheduler was lost, tried again"


class Sent:
    """A function that travels to workers as it is: they cannot import it, as they have nothing of this folder."""

    def __init__(self, function):
        self.pickled = cloudpickle.dumps(function)

    def __reduce__(self):
        return cloudpickle.loads, (self.pickled,)

    def __call__(self, *arguments):
        raise TypeError("this is for workers")


class Chunk:
    """Some steps in a row, and what has become of them so far."""

    def __init__(self, first, end):
        self.first, self.end = first, end
        self.tries = 0
        self.notes = []
        self.avoided = set()
        self.future = None
        self.places = None

    def note(self, words):
        if words not in self.notes:
            self.notes.append(words)


class Farm:
    def __init__(self, options, work):
        self.options, self.job = options, work
        self.rows = []
        self.strikes = Counter()
        self.threads = {}
        self.looked = 0.0
        # Parts by the keys that the scheduler knows them by, and what it said of lost workers.
        self.handed_out = {}
        self.lost = deque()
        cloudpickle.register_pickle_by_value(worker)
        self.work = Sent(worker.work)

    def run(self):
        """Does all chunks; a row of the table for each."""
        local = self.options.scheduler == "local"
        self.cluster = LocalCluster(n_workers=self.options.workers, threads_per_worker=1,
                                    dashboard_address=None) if local else None
        self.client = None
        try:
            self.connect()
            self.wait_for_workers()
            share = len(self.job.outputs) / (8 * max(1, sum(self.threads.values())))
            size = self.options.chunk or min(100, max(1, round(share)))
            waiting = [Chunk(*ends) for ends in reversed(self.job.chunks(size))]
            self.begun, self.steps = time.monotonic(), sum(chunk.end - chunk.first for chunk in waiting)
            self.loop(waiting, [])
            self.note_lost()
            self.tell(last=True)
            return self.rows
        finally:
            self.close()

    def connect(self):
        """Connects to the scheduler, and gives the workers the files of the job."""
        end = time.monotonic() + self.options.patience
        while True:
            try:
                self.client = Client(self.cluster or self.options.scheduler, timeout=10, set_as_default=False)
                self.client.subscribe_topic("all", self.heard)
                self.client.register_plugin(worker.Inputs(self.job), name=self.job.name)
                return
            except ValueError as error:
                raise job.Refused(f"--scheduler is {self.options.scheduler}, expected an address such as tcp://10.0.0.1:8786, "
                                  "or local") from error
            except LOST as error:
                if time.monotonic() > end or self.cluster:
                    raise job.Refused(f"--scheduler {self.options.scheduler}: {error}") from error
                time.sleep(1)

    def wait_for_workers(self):
        end = time.monotonic() + self.options.patience
        while not self.threads:
            if time.monotonic() > end:
                raise job.Refused(f"--scheduler {self.options.scheduler}: it has no workers")
            self.look(0)
            time.sleep(0.1)

    def close(self):
        for thing in (self.client, self.cluster):
            try:
                if thing is self.client and thing is not None and thing.status == "running":
                    thing.unsubscribe_topic("all")
                    thing.unregister_worker_plugin(self.job.name)
                if thing is not None:
                    thing.close()
            except LOST:
                pass  # Whatever is left there goes with the workers.

    def heard(self, event):
        """The scheduler says that something happened; this is called from another thread."""
        _, message = event
        if isinstance(message, dict) and message.get("action") == "remove-worker" and not message.get("expected"):
            self.lost.append((message["worker"], set(map(str, message["processing-tasks"]))))

    def look(self, interval=1.0):
        """Looks, now and then, which workers there are; whether some came or went."""
        if time.monotonic() - self.looked < interval or self.client.status != "running":
            return False
        self.looked = time.monotonic()
        try:
            threads = self.client.nthreads()
        except LOST:
            return False
        changed = threads.keys() != self.threads.keys()
        self.threads = threads
        return changed

    def loop(self, waiting, begun):
        alone = None
        while waiting or begun:
            if self.client.status not in ("running", "connecting"):
                self.reconnect(begun)
            if self.look():
                self.after_change(begun)
            self.note_lost()
            if not self.threads:
                alone = alone or time.monotonic()
                if time.monotonic() - alone > self.options.patience:
                    raise job.Refused(f"--scheduler {self.options.scheduler}: all workers are gone")
            else:
                alone = None
            for chunk in list(begun):
                if self.step(chunk):
                    begun.remove(chunk)
                    if not chunk.done:
                        waiting.append(chunk)
            room = max(4, AHEAD * sum(self.threads.values())) - len(begun)
            while waiting and room > 0 and self.client.status == "running":
                chunk = waiting.pop()
                self.submit(chunk)
                begun.append(chunk)
                room -= 1
            self.tell()
            time.sleep(0.02)

    def reconnect(self, begun):
        for chunk in begun:
            chunk.note(WIRE_LOST)
        self.close()
        self.connect()

    def note_lost(self):
        """Notes which parts lost workers had; the scheduler has given them to others."""
        while self.lost:
            address, keys = self.lost.popleft()
            for key in keys & self.handed_out.keys():
                self.handed_out[key].note(f"{address} was lost, done by another")

    def after_change(self, begun):
        """Parts that were for workers that are all gone are handed out anew."""
        for chunk in begun:
            gone = chunk.places is not None and not chunk.places & self.threads.keys()
            if gone and chunk.future is not None:
                chunk.future.cancel()

    def submit(self, chunk):
        chunk.done = False
        chunk.tries += 1
        bad = {address for address, strikes in self.strikes.items() if strikes >= STRIKES}
        places = self.threads.keys() - bad - chunk.avoided or self.threads.keys() - bad or self.threads.keys()
        restricted = places != self.threads.keys()
        chunk.places = set(places) if restricted else None
        key = f"{self.job.name}-{chunk.first}-{chunk.end}-{chunk.tries}-{time.time_ns()}"
        self.handed_out[key] = chunk
        try:
            chunk.future = self.client.submit(
                self.work, self.job.name, self.job.command, self.job.arguments, chunk.first, chunk.end,
                self.options.worker_threads,
                key=key, pure=False, workers=sorted(places) if restricted else None, priority=-chunk.first,
            )
        except LOST:
            chunk.future = None

    def step(self, chunk):
        """Looks after a chunk that was handed out; whether it is done, or has to be handed out anew."""
        status = "lost" if chunk.future is None else chunk.future.status
        if status == "pending":
            return False
        if status in ("cancelled", "lost"):
            return self.again(chunk, WIRE_LOST, counts=False)
        try:
            told = chunk.future.result(timeout=self.options.patience)
        except CommClosedError:  # The wire was cut while the result was on its way.
            return self.again(chunk, WIRE_LOST, counts=False)
        except Exception as error:  # Whatever went wrong there, the work is still to be done.
            killed = type(error).__name__ == "KilledWorker"
            words = "its workers were lost again and again" if killed else f"{type(error).__name__}: {error}"
            return self.again(chunk, words.splitlines()[0][:200])
        chunk.future = None
        if "trouble" in told:
            self.strikes[told["worker"]] += 1
            chunk.avoided.add(told["worker"])
            return self.again(chunk, f"{told['worker']}: {told['trouble']}; done by another")
        if "failure" in told:
            return self.ended(chunk, told, told["failure"])
        for name, content, digest in told["files"]:
            if hashlib.sha256(content).hexdigest() != digest:
                return self.again(chunk, f"{name} did not arrive as it was sent, sent again")
        for name, content, _ in told["files"]:
            job.replace(Path(name), content)
        return self.ended(chunk, told, None)

    def again(self, chunk, words, counts=True):
        chunk.note(words)
        chunk.future = None
        if counts and chunk.tries > self.options.retries:
            return self.ended(chunk, {}, "tried too often")
        return True

    def ended(self, chunk, told, failure):
        """A row of the table for a chunk that is done, or has failed for good."""
        lines = [line for line in told.get("lines", []) if line["file"] or line.get("error")]
        steps = range(chunk.first, chunk.end)
        failed = {line["step"] for line in lines if line.get("error")}
        certified = {step for step in steps if all(line["certified"] for line in lines if line["step"] == step)}
        for line in lines:
            if line.get("error"):
                chunk.note(line["error"])
        if failure:
            chunk.note(failure)
            failed = set(steps)
        self.rows.append({
            "first": chunk.first,
            "steps": len(steps),
            "seconds": round(sum(line["seconds"] for line in lines), 3),
            "bytes": sum(line["bytes"] or 0 for line in lines if not failure),
            "certified": len(certified - failed),
            "failed": len(failed),
            "tries": chunk.tries,
            "worker": told.get("worker", ""),
            "notes": chunk.notes,
        })
        chunk.done = True
        return True

    def tell(self, last=False):
        """How far the work has got, on a terminal."""
        if not sys.stderr.isatty():
            return
        done = sum(row["steps"] for row in self.rows)
        passed = time.monotonic() - self.begun
        left = f"about {passed * (self.steps - done) / done:.0f} s left" if done else "begun"
        words = f"\r{done}/{self.steps} steps, {len(self.threads)} workers, {passed:.0f} s, {left}   "
        sys.stderr.write(words + ("\n" if last else ""))
        sys.stderr.flush()
