"""Shares the work of `photosurface` out among the workers of a Dask cluster.

    farm.py render film.json --steps=-6..6/10000 -o film/frame.png --scheduler tcp://10.0.0.1:8786 --film film.mp4
    farm.py export street.json --split -o street.glb --scheduler local --chunk 20
    farm.py sweep speeds.json bunny.glb --scheduler local

The arguments are those of the command; the flags of the farm may stand among them. The program says what there is to do
(`--plan`), and each worker does a part of it (`--only A..B --progress json`). Workers need no disk in common with this
machine: the scene and its files go to them, and what they make comes back. Every file is what one machine would have
made, byte for byte.

Needs: pip install dask distributed
"""

import argparse
import sys
from pathlib import Path

import client
import job

TABLES = (".csv", ".json")
FILMS = (".gif", ".png", ".webp", ".mp4")


def flags():
    parser = argparse.ArgumentParser(
        prog="farm.py",
        usage="farm.py render|export|sweep ARGUMENTS --scheduler ADDRESS|local [--chunk N]",
        description="Shares the work of photosurface out among the workers of a Dask cluster.",
        epilog="All other arguments go to the command of photosurface: see photosurface help render.",
        allow_abbrev=False,
    )
    parser.add_argument("command", choices=["render", "export", "sweep"])
    parser.add_argument("--scheduler", required=True, metavar="ADDRESS",
                        help="address of the scheduler, such as tcp://10.0.0.1:8786; or local, for workers on this machine")
    parser.add_argument("--workers", type=int, metavar="N", help="number of workers of --scheduler local")
    parser.add_argument("--chunk", type=int, metavar="N",
                        help="steps, or runs of a sweep, that a worker does at a time [default: an eighth of each one's share]")
    parser.add_argument("--program", default="photosurface", metavar="PATH",
                        help="the program, here and on the workers [default: photosurface]")
    parser.add_argument("--send-program", action="store_true",
                        help="send this machine's program to the workers, which must be machines of the same kind")
    parser.add_argument("--worker-threads", type=int, metavar="N",
                        help="threads of each program [default: the cores of the worker over the tasks it runs at once]")
    parser.add_argument("--retries", type=int, default=5, metavar="N",
                        help="how often a part is tried anew before it counts as failed [default: 5]")
    parser.add_argument("--patience", type=float, default=300, metavar="S",
                        help="seconds to wait for the scheduler and for workers when there are none [default: 300]")
    parser.add_argument("--table", metavar="FILE", help="write the table as .csv or .json as well")
    parser.add_argument("--film", metavar="FILE",
                        help="join the pictures of render to a film (.gif, .png, .webp, .mp4); they stay")
    parser.add_argument("--fps", metavar="N", help="frames per second of the film")
    return parser


def main(words):
    options, arguments = flags().parse_known_args(words)
    for name in ("chunk", "workers", "worker_threads"):
        if getattr(options, name) is not None and getattr(options, name) < 1:
            raise job.Refused(f"--{name.replace('_', '-')} is too small, expected at least 1")
    if options.film and options.command != "render":
        raise job.Refused("--film is for render, which makes pictures")
    if options.fps and not options.film:
        if options.command == "export":
            arguments += ["--fps", options.fps]
        else:
            raise job.Refused("--fps is for --film")
    for name, extensions in (("table", TABLES), ("film", FILMS)):
        file = getattr(options, name)
        if file and Path(file).suffix.lower() not in extensions:
            raise job.Refused(f"--{name} is {file}, expected a file named {', '.join(extensions)}")
    work = job.Job(options, arguments)
    rows = client.Farm(options, work).run()
    if options.film and not any(row["failed"] for row in rows):
        work.join(Path(options.film), options.fps)
    work.write_table(rows, options.table)
    return work.status(rows)


if __name__ == "__main__":
    try:
        sys.exit(main(sys.argv[1:]))
    except job.Refused as error:
        print(f"error: {error}", file=sys.stderr)
        sys.exit(2)
    except KeyboardInterrupt:
        print("interrupted; files that came back stay", file=sys.stderr)
        sys.exit(130)
