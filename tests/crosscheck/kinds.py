"""Every kind of glTF file that the program writes: what three.js and Blender are asked about.

A kind is a function of the fixture `export` and of a directory for sources; it returns the paths of its files.
"""

from handmade import write_hierarchy
from scenes import CUBE, SEVERAL, SPHERE, TORUS, write_obj


def scene(source, *flags, to="out.glb"):
    """The one file of this scene."""
    return lambda export, directory: [export(source, *flags, to=to)]


def split(source):
    """A file for each step of this scene."""

    def files(export, directory):
        return sorted(export(source, "--split", to="split.glb").parent.glob("*.glb"))

    return files


def mesh(write, *flags, steps=(0, 1), to="out.glb"):
    """A mesh from a file of another program, flown by; `write` makes the file in a directory."""

    def files(export, directory):
        spec = {"name": "thing", "file": str(write(directory)), "position": [0.5, 0, -5], "scale": 0.5}
        observer = {"velocity": [0, 0, -0.9]}
        return [export({"observer": observer, "objects": [spec], "steps": list(steps)}, *flags, to=to)]

    return files


# The observer passes in seven steps, of which the first is not at the beginning of time.
PASSING = {**SPHERE, "observer": {**SPHERE["observer"], "marker": 0.2}, "steps": [-6, -4, -2, 0, 2, 4, 6]}
FRAMES_PER_SECOND = 24

# Kinds that play seven steps.
PLAYING = {
    f"{name} as {words}": kind(flag)
    for flag, words in [("--animate", "frames"), ("--animate=morph", "morph targets")]
    for name, kind in {
        "steps": lambda flag: scene(PASSING, flag),
        "steps with a camera": lambda flag: scene(PASSING, flag, "--camera", "--track"),
        "a hierarchy with a texture": lambda flag: mesh(write_hierarchy, flag, steps=range(7)),
        "an OBJ with materials": lambda flag: mesh(write_obj, flag, steps=range(7)),
    }.items()
}


KINDS = {
    "one step": scene(TORUS),
    "several steps": scene(SPHERE),
    "a camera for each step": scene(PASSING, "--camera"),
    "a file for each step": split(SPHERE),
    "a buffer of its own": scene(CUBE, to="out.gltf"),
    "marker and checker": scene(SEVERAL),
    "checker beside a buffer of its own": scene(SEVERAL, to="out.gltf"),
    "hierarchy with a texture": mesh(write_hierarchy),
    "materials of an OBJ": mesh(write_obj),
    "materials of an OBJ beside a buffer of its own": mesh(write_obj, to="out.gltf"),
    "attributes": scene(PASSING, "--attributes", "doppler,emission_time,rest_position,radiance"),
    "Doppler colours": scene(SEVERAL, "--doppler", "spectrum"),
    "Doppler colours of textures": mesh(write_hierarchy, "--doppler", "spectrum"),
    **PLAYING,
}
