"""What is to be done, as the program itself says, and what became of it."""

import csv
import hashlib
import io
import json
import os
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path


class Refused(Exception):
    """What was asked for is not possible; the message says why."""


# Flags that the farm gives to the program itself.
OWN = ("--only", "--progress", "--threads", "--plan", "--planned")


class Job:
    """A command of the program, the parts that it has, and the files that it reads."""

    def __init__(self, options, arguments):
        self.command = options.command
        self.program = options.program
        for word in arguments:
            if word.split("=")[0] in OWN:
                raise Refused(f"{word.split('=')[0]} is what the farm says to its workers; leave it out")
            if word.split("=")[0] == "--report":
                raise Refused("--report is for a run on one machine; the farm has --table")
        # The same names here and on the workers, whose folders are others.
        self.arguments = [relative(word) for word in arguments]
        is_render = self.command == "render"
        plan = json.loads(self.run(self.command, *self.arguments, "--plan=files" if is_render else "--plan"))
        self.version, self.of = plan["version"], plan["of"]
        self.outputs = {}
        for output in plan["outputs"]:
            first, end = output["steps"]
            if end - first != 1 and self.of > 1:
                raise Refused(f"{output['file']} holds {end - first} steps; add --split, for a file of each step")
            self.outputs.setdefault(first, []).append(output)
        self.finished = [n for n, files in self.outputs.items() if all(file["finished"] for file in files)]
        self.resumed_are_certified = all(
            file["certified"] for n in self.finished for file in self.outputs[n])
        self.files = self.read(plan["inputs"], options.send_program)
        if is_render and len(self.outputs) - len(self.finished) > 1:
            self.look()
        digest = hashlib.sha256(json.dumps([self.version, self.command, self.arguments]).encode())
        for name, content in sorted(self.files.items()):
            digest.update(f"{name}\0{len(content)}\0".encode() + content)
        self.name = f"photosurface-{digest.hexdigest()[:16]}"

    def look(self):
        """Looks at all steps once, here, for what their pictures have in common, so that no part has to."""
        if sys.stderr.isatty():
            print(f"looking at all {self.of} steps", file=sys.stderr)
        plan = json.loads(self.run(self.command, *self.arguments, "--plan"))
        if plan["overview"]:
            # Without the files, which no part asks for.
            self.files["/plan"] = json.dumps({"version": plan["version"], "overview": plan["overview"]}).encode()

    def run(self, *words):
        """Runs the program here; what it prints."""
        program = shutil.which(self.program)
        if program is None:
            raise Refused(f"{self.program}: no such program; say where it is with --program")
        done = subprocess.run([program, *words], capture_output=True, stdin=subprocess.DEVNULL)
        if done.returncode != 0:
            lines = done.stderr.decode(errors="replace").splitlines()
            told = [line for line in lines if line.startswith("error: ")] or lines[-1:] or ["it failed"]
            raise Refused(told[0].removeprefix("error: "))
        return done.stdout

    def read(self, inputs, with_program):
        """The bytes of all files that workers need, by their names."""
        files = {}
        for name in inputs:
            if name == "-":
                raise Refused("stdin cannot be sent to workers, expected a file")
            if os.path.isabs(name):
                raise Refused(f"{name} is named by its absolute path, which workers do not have; expected a relative one")
            files[name] = Path(name).read_bytes()
        if with_program:
            files["/program"] = Path(shutil.which(self.program)).read_bytes()
        return files

    def packed(self):
        """All files in one, by their places below the root of this machine."""
        pack = io.BytesIO()
        with zipfile.ZipFile(pack, "w", zipfile.ZIP_DEFLATED, compresslevel=1) as packed:
            for name, content in self.files.items():
                place = name[1:] if name in ("/program", "/plan") else "root" + os.path.abspath(name)
                packed.writestr(place, content)
        return pack.getvalue()

    def folders(self):
        """Folders that must be there before the program begins."""
        files = [output["file"] for outputs in self.outputs.values() for output in outputs if output["file"]]
        words = self.arguments
        allowed = [word for flag, word in zip(words, words[1:]) if flag == "--allow-read"]
        allowed += [word.partition("=")[2] for word in words if word.startswith("--allow-read=")]
        return sorted({os.path.abspath(os.path.dirname(file)) for file in files} | set(map(os.path.abspath, allowed)) | {os.getcwd()})

    def chunks(self, size):
        """The parts to do, as (first, end): steps in a row that are not finished."""
        left = sorted(set(self.outputs) - set(self.finished))
        chunks = []
        for number in left:
            if chunks and chunks[-1][1] == number and number - chunks[-1][0] < size:
                chunks[-1][1] = number + 1
            else:
                chunks.append([number, number + 1])
        return [tuple(chunk) for chunk in chunks]

    def join(self, film, fps):
        """Joins all pictures to a film."""
        pictures = [outputs[0]["file"] for _, outputs in sorted(self.outputs.items())]
        self.run("join", *pictures, "-o", str(film), *(["--fps", fps] if fps else []))
        print(f"{film}: {len(pictures)} frames", file=sys.stderr)

    def write_table(self, rows, path):
        rows = sorted(rows, key=lambda row: row["first"])
        total = {
            "steps": sum(row["steps"] for row in rows),
            "seconds": round(sum(row["seconds"] for row in rows), 3),
            "bytes": sum(row["bytes"] for row in rows),
            "certified": sum(row["certified"] for row in rows),
            "failed": sum(row["failed"] for row in rows),
        }
        shown = rows if len(rows) <= 40 else [row for row in rows if row["notes"] or row["failed"]]
        columns = ["first", *total, "tries", "worker", "notes"]
        cells = [columns] + [[text(row[column]) for column in columns] for row in shown]
        cells.append(["all", *map(str, total.values()), str(sum(row["tries"] for row in rows)), "", ""])
        widths = [max(len(line[column]) for line in cells) for column in range(len(columns) - 1)]
        for line in cells:
            print("  ".join([cell.rjust(width) for cell, width in zip(line, widths)] + [line[-1]]).rstrip())
        if self.finished:
            but = "" if self.resumed_are_certified else ", not all within their tolerance"
            print(f"{len(self.finished)} of {self.of} were finished before{but}")
        if path and path.endswith(".json"):
            content = json.dumps({"version": self.version, "total": total, "chunks": rows}, indent=1) + "\n"
        elif path:
            lines = io.StringIO()
            writer = csv.writer(lines, lineterminator="\n")
            writer.writerows([columns, *([text(row[column]) for column in columns] for row in rows)])
            content = lines.getvalue()
        if path:
            replace(Path(path), content.encode())

    def status(self, rows):
        if any(row["failed"] for row in rows):
            return 2
        done = all(row["certified"] == row["steps"] for row in rows)
        return 0 if done and self.resumed_are_certified else 1


def text(cell):
    return "; ".join(cell) if isinstance(cell, list) else str(cell)


def relative(word):
    """An argument whose absolute path, if it is one, is relative to this directory."""
    flag, sign, value = word.partition("=") if word.startswith("--") else ("", "", word)
    return flag + sign + os.path.relpath(value) if os.path.isabs(value) else word


def replace(path, content):
    """Writes a file, which appears whole or not at all."""
    unfinished = path.with_name(f".{path.name}.{os.getpid()}")
    try:
        unfinished.write_bytes(content)
        os.replace(unfinished, path)
    except OSError as error:
        unfinished.unlink(missing_ok=True)
        raise Refused(f"{path}: {error.strerror}") from error
