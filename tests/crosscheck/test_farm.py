"""examples/farm: a film and a sweep on a real scheduler and three workers, which have no disk in common.

Every file has to be what one machine makes, byte for byte, whatever goes wrong on the way: a worker is killed, the wire to
the scheduler is held still and cut, a disk is full, files are half-copied.
"""

import json
import os
import resource
import shutil
import subprocess
from pathlib import Path

import pytest
from cluster import Cluster, Gate, Run, Wire

BINARY = os.environ["PHOTOSURFACE_BINARY"]
MESH = Path(__file__).resolve().parents[2] / "fixtures" / "meshes" / "asteroid.glb"

SCENE = {
    "observer": {"velocity": {"beta": 0.9, "direction": [-1, 0, 0]}},
    "objects": [{"name": "stone", "file": "meshes/stone.glb", "position": [0, 3, 0]},
                {"name": "ball", "shape": {"sphere": {"radius": 1}}, "position": [0, -3, 0]}],
}
FILM = ["render", "scene.json", "--steps=-6..6/300", "--size", "32x18", "--samples", "1", "-o", "out/frame.png"]
SWEEP = ["sweep", "speeds.json", "meshes/stone.glb", "-o", "out"]
RUNS = 200


@pytest.fixture(scope="module")
def cluster(tmp_path_factory):
    cluster = Cluster(tmp_path_factory.mktemp("cluster"))
    for name in ("one", "two", "three"):
        cluster.worker(name)
    cluster.ready("one", "two", "three")
    yield cluster
    print(cluster.logs())
    cluster.close()


def workplace(folder):
    """A folder with the scene, its mesh and a list of runs."""
    (folder / "meshes").mkdir()
    (folder / "out").mkdir()
    shutil.copy(MESH, folder / "meshes" / "stone.glb")
    (folder / "scene.json").write_text(json.dumps(SCENE))
    runs = [{"name": f"v{number:03}", "beta": number / (RUNS + 1)} for number in range(RUNS)]
    (folder / "speeds.json").write_text(json.dumps({"all": {"tolerance": "1e-2"}, "runs": runs}))
    return folder


@pytest.fixture
def here(tmp_path):
    return workplace(tmp_path)


@pytest.fixture(scope="module")
def expected(tmp_path_factory):
    """The files of a command on one machine, by their names; each command once."""
    known = {}

    def files(words):
        key = tuple(words)
        if key not in known:
            folder = workplace(tmp_path_factory.mktemp("alone"))
            done = subprocess.run([BINARY, *words], cwd=folder, capture_output=True, text=True)
            assert done.returncode == 0, done.stderr
            known[key] = contents(folder)
        return known[key]

    return files


def contents(folder):
    """All files in the folder of results, hidden ones too."""
    return {path.name: path.read_bytes() for path in (folder / "out").iterdir()}


def finished(run, here, files, steps):
    """The run went well: nothing is lost, nothing is doubled, every byte is right. The chunks of its table."""
    status, out, err = run.ended()
    assert status == 0, f"{run.command} gave {status}\n{out}\n{err}"
    made = contents(here)
    assert made.keys() == files.keys()
    different = [name for name in files if made[name] != files[name]]
    assert not different, different
    table = json.loads((here / "table.json").read_text())
    counted = [step for row in table["chunks"] for step in range(row["first"], row["first"] + row["steps"])]
    assert sorted(counted) == list(steps), "each step is in one row"
    assert table["total"]["certified"] == len(counted)
    assert table["total"]["failed"] == 0
    assert out.splitlines()[0].split()[:6] == ["first", "steps", "seconds", "bytes", "certified", "failed"]
    return table["chunks"]


def notes(chunks):
    return "\n".join(note for row in chunks for note in row["notes"])


def test_a_film_while_a_worker_is_killed(cluster, here, expected, tmp_path_factory):
    files = expected(FILM)
    assert len(files) == 300
    gate = Gate(tmp_path_factory.mktemp("gate"), BINARY, 30)
    run = Run(here, cluster.address, *FILM, "--program", gate.program, "--chunk", 10, "--film", "film.gif")
    run.when("out/frame_step*.png", 30)
    gate.held(3)
    cluster.kill("two")
    gate.open()
    chunks = finished(run, here, files, range(300))
    assert "was lost, done by another" in notes(chunks), chunks
    cluster.worker("two")
    cluster.ready("two")
    # The film is that of the frames of one machine.
    frames = sorted(map(str, (here / "out").iterdir()))
    subprocess.run([BINARY, "join", *frames, "-o", here / "alone.gif", "-q"], check=True)
    assert (here / "film.gif").read_bytes() == (here / "alone.gif").read_bytes()


def test_a_sweep_over_a_bad_wire(cluster, here, expected, tmp_path_factory):
    """The client's wire to the scheduler is held still for some seconds, later cut, and mended."""
    files = expected(SWEEP)
    assert len(files) == RUNS
    wire = Wire(cluster.port)
    gate = Gate(tmp_path_factory.mktemp("gate"), BINARY, 60)
    run = Run(here, wire.address, *SWEEP, "--program", gate.program, "--chunk", 10)
    run.when("out/*.glb", 20)
    wire.hold(3)
    run.when("out/*.glb", 60)
    gate.held(3)
    wire.cut(3)
    gate.open()
    chunks = finished(run, here, files, range(RUNS))
    assert "connection to the scheduler was lost, tried again" in notes(chunks), chunks


def test_a_full_disk(cluster, here, expected):
    """A worker that has no room for the files; the work is done by the others, and the table says why."""
    files = expected(SWEEP)
    largest = max(map(len, files.values()))

    def no_room():
        resource.setrlimit(resource.RLIMIT_FSIZE, (largest // 2, largest // 2))

    disk = cluster.folder / "full"
    disk.mkdir()
    size = MESH.stat().st_size + 24_000
    is_mounted = subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={size}", "farm", disk], capture_output=True).returncode == 0
    try:
        # Without the right to mount a small disk, the process itself may write no large file.
        cluster.worker("full", before=None if is_mounted else no_room)
        cluster.ready("full")
        run = Run(here, cluster.address, *SWEEP, "--program", BINARY, "--chunk", 5)
        chunks = finished(run, here, files, range(RUNS))
    finally:
        cluster.kill("full")
        if is_mounted:
            subprocess.run(["umount", "-l", disk], check=True)
    assert any(words in notes(chunks) for words in ("No space left", "File too large", "signal 25")), chunks


def test_half_copied_files(cluster, here, expected, tmp_path_factory):
    """Files that are half-copied on a worker are made again, and so are those in the folder of results."""
    files = expected([*FILM, "--resume"])
    # On one worker the program of this name leaves half of each file.
    wrong, right = tmp_path_factory.mktemp("wrong"), tmp_path_factory.mktemp("right")
    (wrong / "shared-name").write_text(
        "#!/bin/sh\n" f'"{BINARY}" "$@"; status=$?\n' "for file in out/*.png; do\n"
        '  [ -f "$file" ] && truncate -s -100 "$file"\n' "done; exit $status\n")
    (right / "shared-name").symlink_to(BINARY)
    (wrong / "shared-name").chmod(0o755)
    for name in ("one", "two", "three"):
        cluster.kill(name)
        cluster.worker(name, path=right)
    cluster.worker("half", path=wrong)
    cluster.ready("one", "two", "three", "half")
    os.environ["PATH"], before = f"{right}:{os.environ['PATH']}", os.environ["PATH"]
    try:
        words = [*FILM, "--resume", "--program", "shared-name", "--chunk", 10]
        chunks = finished(Run(here, cluster.address, *words), here, files, range(300))
        assert "bytes; done by another" in notes(chunks), chunks
        cluster.kill("half")
        # Of the results one is lost, one half-copied, one has another byte; all others stay.
        out = here / "out"
        (out / "frame_step000.png").unlink()
        (out / "frame_step017.png").write_bytes(files["frame_step017.png"][:200])
        spoiled = bytearray(files["frame_step200.png"])
        spoiled[-20] ^= 1
        (out / "frame_step200.png").write_bytes(spoiled)
        kept = (out / "frame_step100.png").stat()
        finished(Run(here, cluster.address, *words), here, files, [0, 17, 200])
        assert (out / "frame_step100.png").stat().st_mtime_ns == kept.st_mtime_ns
    finally:
        os.environ["PATH"] = before


def test_parts_of_a_film_take_what_was_found_once(cluster, here, expected):
    """The client looks at all steps once; no part does. The exposure depends on all of them, as the camera does."""
    scene = SCENE | {"effects": {"searchlight": True, "exposure": "auto"}}
    words = ["render", "lit.json", "--steps=-6..6/60", "--size", "32x18", "--samples", "1", "-o", "out/frame.png"]
    (here / "lit.json").write_text(json.dumps(scene))
    subprocess.run([BINARY, *words, "-q"], cwd=here, check=True)
    files = contents(here)
    for name in files:
        (here / "out" / name).unlink()
    # On every worker, the program tells how it was called.
    told = here / "told.txt"
    program = here / "told-name"
    program.write_text("#!/bin/sh\n" f'echo "$@" >>"{told}"\n' f'exec "{BINARY}" "$@"\n')
    program.chmod(0o755)
    finished(Run(here, cluster.address, *words, "--program", program, "--chunk", 20), here, files, range(60))
    calls = told.read_text().splitlines()
    assert sum("--plan" in call.split() for call in calls) == 1, calls
    parts = [call for call in calls if "--only" in call]
    assert len(parts) == 3 and all("--planned=" in call for call in parts), calls
    # A plan that is damaged on its way is an error, and nothing is drawn by it.
    plan = json.loads(subprocess.run([BINARY, *words, "--plan"], cwd=here, check=True, capture_output=True).stdout)
    plan["overview"]["found"]["exposure"] += 1
    (here / "plan.json").write_text(json.dumps(plan))
    wrong = subprocess.run([BINARY, *words, "--only=0..1", "--planned=plan.json"], cwd=here, capture_output=True, text=True)
    assert wrong.returncode == 2 and "is damaged" in wrong.stderr, wrong.stderr


def test_what_cannot_be_done_is_said(cluster, here):
    """Errors of the work itself are not tried again and again."""
    for words, expected in [
        (["export", "scene.json", "--steps=0,1", "-o", "out/a.glb"], "--split"),
        (["render", "none.json"], "none.json"),
        (["render", "scene.json", "--only", "0..1"], "--only"),
        (["export", here / "scene.json", "--bta", "0.5"], "--bta"),
        (["render", "scene.json", "--film", "film.xyz"], "--film"),
    ]:
        status, out, err = Run(here, cluster.address, *words, "--program", BINARY).ended()
        assert (status, out) == (2, ""), err
        assert err.startswith("error: ") and expected in err and len(err.splitlines()) == 1, err
    status, out, err = Run(here, "nowhere", "render", "scene.json", "--program", BINARY).ended()
    assert (status, out) == (2, "") and "--scheduler is nowhere" in err, err
    # A run that fails is a line of the table; the others are there.
    (here / "speeds.json").write_text(json.dumps([{"beta": 0.5}, {"beta": 1.5}, {"beta": 0.6}]))
    status, out, err = Run(here, cluster.address, *SWEEP, "--program", BINARY, "--chunk", 3).ended()
    assert status == 2, err
    assert sorted(contents(here)) == ["run000.glb", "run002.glb"]
    table = json.loads((here / "table.json").read_text())
    assert (table["total"]["failed"], table["total"]["certified"]) == (1, 2)
    assert "1.5" in notes(table["chunks"])


def test_what_an_earlier_run_could_not_certify_is_told_again(cluster, here):
    words = ["export", "scene.json", "--steps=0,1", "--split", "--no-subdivide", "-o", "out/a.glb", "--resume"]
    for _ in range(2):
        status, out, err = Run(here, cluster.address, *words, "--program", BINARY).ended()
        assert status == 1, err
    assert "2 of 2 were finished before, not all within their tolerance" in out
