"""What sharing work out costs: the time of a part beside its own work, the chunk that follows, what a film costs; sweeps.

    python -m venv target/farm && target/farm/bin/pip install -r examples/farm/requirements.txt
    cargo build --release
    target/farm/bin/python tests/bench/farm.py target/release/photosurface ENGINE.glb

ENGINE is any mesh; that of the tables in examples/farm/README.md is Khronos' 2CylinderEngine, 75,730 triangles. Programs run
with one thread, and their times are those of the processor, so that other work on the machine does not count; the median of
several runs, but of one frame in 4K.
"""

import json
import os
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

FARM = Path(__file__).resolve().parents[2] / "examples" / "farm" / "farm.py"
ROUNDS = 3
RUNS = 200
FRAMES = 10_000
LOST = 0.05


def timed(words, folder):
    """Seconds of the processor, and peak memory in MB."""
    process = subprocess.Popen(words, cwd=folder, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
    said = process.stderr.read()
    _, status, usage = os.wait4(process.pid, 0)
    seconds = usage.ru_utime + usage.ru_stime
    process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode not in (0, 1):
        sys.exit(f"{words} ended with {process.returncode}\n{said.decode(errors='replace')}")
    return seconds, usage.ru_maxrss / 1000


def median(words, folder, rounds=ROUNDS):
    return statistics.median(timed(words, folder)[0] for _ in range(rounds))


class Work:
    """A command of the program of which parts are made, in a folder."""

    def __init__(self, program, folder, *words):
        self.words, self.folder = [program, *words], folder
        self.is_render = words[0] == "render"

    def all_words(self, whole, only):
        return [*self.words, f"--steps=-6..6/{whole}", f"--only=0..{only}", "--threads=1", "-q", *self.planned(whole)]

    def planned(self, whole):
        """The plan of the whole, in which a picture's camera and exposure are found."""
        if not self.is_render:
            return []
        plan = Path(self.folder) / f"plan{whole}.json"
        plan.write_bytes(self.plan(whole)[1])
        return [f"--planned={plan.name}"]

    def plan(self, whole):
        """Seconds of the processor for a plan, and the plan."""
        words = [*self.words, f"--steps=-6..6/{whole}", "--plan", "-q"]
        before = os.times()
        plan = subprocess.run(words, cwd=self.folder, check=True, capture_output=True).stdout
        after = os.times()
        return after.children_user + after.children_system - before.children_user - before.children_system, plan

    def part(self, rounds=ROUNDS, steps=9):
        """Seconds of a step; of a part without steps; of each step that the whole has beside those of the part."""
        few, many = (100, 500) if self.is_render else (100, FRAMES)
        runs = [(few, 1), (few, steps), (many, 1)]
        small, large, long = (median(self.all_words(*run), self.folder, rounds) for run in runs)
        step = (large - small) / (steps - 1)
        of_whole = max(0.0, (long - small) / (many - few))
        return step, max(0.0, small - step - few * of_whole), of_whole

    def look(self):
        """Seconds of the processor that the plan takes for each step of the whole."""
        few, many = (statistics.median(self.plan(whole)[0] for _ in range(ROUNDS)) for whole in (100, 500))
        return max(0.0, (many - few) / 400)


def handed_out(program, folder, name, parts=100):
    """Seconds of the processor that a part costs on a cluster, and run directly; the length of its file.

    Those of the client, the scheduler and one worker together, which are processes here; the files come back over the
    connection.
    """
    words = ["export", name, f"--steps=-6..6/{parts}", "--split", "--no-subdivide", "-o", "part.glb"]
    farm = [sys.executable, str(FARM), *words, "--program", program, "--worker-threads", "1"]
    on_farm, direct = [], []
    for chunk in (1, parts):
        on_farm.append(median([*farm, "--scheduler", "local", "--workers", "1", "--chunk", str(chunk)], folder))
        direct.append(sum(timed([program, *words, f"--only={first}..{first + chunk}", "--threads=1", "-q"], folder)[0]
                          for first in range(0, parts, chunk)))
    more = parts - 1  # So many parts more, each with the start of a program.
    size = (Path(folder) / "part_step000.glb").stat().st_size
    return (on_farm[0] - on_farm[1]) / more, (direct[0] - direct[1]) / more, size


def seconds(number):
    for unit, size in [("d", 86400), ("h", 3600), ("min", 60)]:
        if number >= size:
            return f"{number / size:.1f} {unit}"
    return f"{number:.3g} s"


def chunk_of(step, fixed):
    """The chunk of which the fixed costs are a twentieth."""
    return max(1, round(fixed * (1 - LOST) / LOST / step))


def main(program, engine):
    program, engine = os.path.abspath(program), os.path.abspath(engine)
    with tempfile.TemporaryDirectory() as folder:
        name = "engine" + Path(engine).suffix
        (Path(folder) / name).write_bytes(Path(engine).read_bytes())
        (Path(folder) / "one.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
        print("| a part with one file of | on the cluster | run directly | handing out, and bringing back |\n|---|---|---|---|")
        handed = 0.0
        for mesh in ("one.obj", name):
            farm, direct, size = handed_out(program, folder, mesh)
            handed = max(handed, farm - direct)
            print(f"| {size / 1000:.0f} kB | {seconds(farm)} | {seconds(direct)} | {1000 * (farm - direct):.1f} ms |", flush=True)
        print("\n| work | a step | start and reading | each step of the whole, in a part | in the plan "
              "| fixed costs of a part of 10,000 steps | chunk |")
        print("|---|---|---|---|---|---|---|")
        costs = {}

        def tell(title, step, start, of_whole, look=0.0):
            fixed = handed + start + FRAMES * of_whole
            costs[title] = step, fixed, look
            print(f"| {title} | {seconds(step)} | {seconds(start)} | {of_whole * 1e6:.0f} µs | {look * 1e3:.1f} ms "
                  f"| {seconds(fixed)} | {chunk_of(step, fixed)} |", flush=True)

        for title, flags in [("export of the engine, certified", ["--max-triangles=none"]), ("the same with a budget", []),
                             ("export, as it is", ["--no-subdivide"])]:
            tell(title, *Work(program, folder, "export", name, "--split", "-o", "a.glb", *flags).part())
        small, large = ["--size", "320x180", "--samples", "1"], ["--size", "3840x2160"]
        for scene, named in [("the engine", [name]), ("the built-in street", ["--example", "street"])]:
            for method in ("rays", "mesh"):
                words = ["render", *named, "--method", method, "-o", "a.png"]
                work = Work(program, folder, *words, *small)
                step, start, of_whole = work.part()
                look = work.look()
                tell(f"picture of {scene}, 320x180, 1 ray per pixel, {method}", step, start, of_whole, look)
                # One frame, once.
                whole, _ = timed(Work(program, folder, *words, *large).all_words(100, 1), folder)
                tell(f"picture of {scene}, 3840x2160, 9 rays per pixel, {method}", whole - start - 100 * of_whole, start,
                     of_whole, look)
        step, fixed, look = costs["picture of the engine, 3840x2160, 9 rays per pixel, rays"]
        print(f"\na film of {FRAMES} frames of 3840x2160, a frame {seconds(step)}, all on one thread each")
        print("\n| workers | chunk | plan | parts | of which fixed costs | together |\n|---|---|---|---|---|---|")
        for workers in (1, 10, 100):
            # A chunk of which the fixed costs are small, and at the end of which few wait for others.
            chunk = max(1, min(100, FRAMES // (8 * workers)))
            rounds = -(-FRAMES // (chunk * workers))
            parts = rounds * (fixed + chunk * step)
            print(f"| {workers} | {chunk} | {seconds(FRAMES * look)} | {seconds(parts)} | {100 * rounds * fixed / parts:.2g} % "
                  f"| {seconds(FRAMES * look + parts)} |")
        sweeps(program, folder, name)


def sweeps(program, folder, name):
    """A sweep against as many runs."""
    def listed(runs):
        steps = [{"name": f"v{run:03}", "beta": run / (RUNS + 1)} for run in range(runs)]
        (Path(folder) / "list.json").write_text(json.dumps(steps))
        return [program, "sweep", "list.json", name, "--threads=1", "-q"]

    print("\n| runs | sweep | as many commands | ratio | memory of the sweep |\n|---|---|---|---|---|")
    for title, flags in [("certified", []), ("as it is", ["--no-subdivide"])]:
        for runs in (20, RUNS):
            words = listed(runs)
            entries = json.loads((Path(folder) / "list.json").read_text())
            every = {"all": {flag[2:]: True for flag in flags}, "runs": entries}
            (Path(folder) / "list.json").write_text(json.dumps(every))
            swept, memory = timed(words, folder)
            alone = 0.0
            for run in entries:
                one = [program, "export", name, *flags, "--beta", str(run["beta"]), "-o", "one.glb", "--threads=1", "-q"]
                alone += timed(one, folder)[0]
            print(f"| {runs}, {title} | {seconds(swept)} | {seconds(alone)} | {alone / swept:.2f} | {memory:.0f} MB |")


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    main(*sys.argv[1:])
