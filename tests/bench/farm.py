"""What sharing work out costs: the time of a part beside its own work, the chunk that follows, what a film costs; sweeps.

    python -m venv target/farm && target/farm/bin/pip install -r examples/farm/requirements.txt
    cargo build --release
    target/farm/bin/python tests/bench/farm.py target/release/photosurface ENGINE.glb

ENGINE is any mesh; that of the tables in examples/farm/README.md is Khronos' 2CylinderEngine, 75,730 triangles. Programs run
with one thread, and their times are those of the processor, so that other work on the machine does not count; the median of
several runs. What the cluster itself takes is by the wall clock.
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


def part(program, words, folder, steps=(FRAMES // 100, FRAMES)):
    """Seconds of a step, of a part without steps, and of each step that the whole has beside those of the part."""
    def run(whole, only):
        all_words = [program, *words, f"--steps=-6..6/{whole}", f"--only=0..{only}", "--threads=1", "-q"]
        return median(all_words, folder)

    few, many = steps
    small, large, long = run(few, 1), run(few, 9), run(many, 1)
    step = (large - small) / 8
    of_whole = max(0.0, (long - small) / (many - few))
    return step, max(0.0, small - step - few * of_whole), of_whole


def cluster(program, folder, engine):
    """Seconds that a part costs on the cluster beside what the program itself takes."""
    words = ["export", engine, "--steps=-6..6/60", "--split", "--no-subdivide", "-o", "part.glb"]
    farm = [sys.executable, str(FARM), *words, "--program", program, "--worker-threads", "1"]
    walls = []
    for chunk in (1, 60):
        start = time.perf_counter()
        subprocess.run([*farm, "--scheduler", "local", "--workers", "1", "--chunk", str(chunk)], cwd=folder, check=True,
                       stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        walls.append(time.perf_counter() - start)
    # 59 parts more, each with the start of a program.
    return (walls[0] - walls[1]) / 59


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
        handed = cluster(program, folder, name)
        print(f"a part on the cluster, with the start of a program that reads the mesh: {seconds(handed)}")
        print("\n| work | a step | start and reading | each step of the whole | fixed costs of a part of 10,000 steps | chunk |")
        print("|---|---|---|---|---|---|")
        costs = {}
        for title, words in [
            ("export of the engine, certified", ["export", name, "--split", "-o", "a.glb"]),
            ("export, as it is", ["export", name, "--split", "--no-subdivide", "-o", "a.glb"]),
            ("picture, 320x180, 1 ray per pixel", ["render", name, "--size", "320x180", "--samples", "1", "-o", "a.png"]),
            ("picture, 3840x2160, 9 rays per pixel", ["render", name, "--size", "3840x2160", "-o", "a.png"]),
        ]:
            step, start, of_whole = part(program, words, folder)
            fixed = max(handed, start) + FRAMES * of_whole
            costs[title] = step, fixed
            print(f"| {title} | {seconds(step)} | {seconds(start)} | {of_whole * 1e6:.0f} µs | {seconds(fixed)} "
                  f"| {chunk_of(step, fixed)} |")
        step, fixed = costs["picture, 3840x2160, 9 rays per pixel"]
        print(f"\na film of {FRAMES} frames of 3840x2160, a frame {seconds(step)} on one thread")
        print("\n| workers | chunk | time | of which fixed costs |\n|---|---|---|---|")
        for workers in (1, 10, 100):
            chunk = min(chunk_of(step, fixed), -(-FRAMES // workers))
            rounds = -(-FRAMES // (chunk * workers))
            total = rounds * (fixed + chunk * step)
            print(f"| {workers} | {chunk} | {seconds(total)} | {100 * rounds * fixed / total:.1f} % |")
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
