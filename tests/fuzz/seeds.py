#!/usr/bin/env python3
"""Writes the hand-made inputs of the targets, among them those that once went wrong.

    python3 tests/fuzz/seeds.py

The encoding of cases for `export` and `render` is that of `src/targets/case.rs`; where that changes, this follows.
"""

import base64
import json
import math
import re
import struct
from pathlib import Path

HERE = Path(__file__).parent
REST = {"form": 0}
CUBE = dict(corners=None, kind=1, numbers=[1, 1, 1])
TRIANGLE = ([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(1, 2, 3)])
PLATE = ([(-1, 0, -1), (1, 0, -1), (1, 0, 1), (-1, 0, 1)], [(1, 2, 3), (1, 3, 4)])
SQUARE = ([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)], [(1, 2, 3), (1, 3, 4)])
SHAPES = {"sphere": 1, "box": 3, "cylinder": 2, "cone": 2, "torus": 2, "rod": 2, "grid": 1, "lattice": 0}


def table():
    """The numbers that one byte stands for."""
    text = (HERE / "src/targets/given.rs").read_text()
    text = re.search(r"NUMBERS: \[f64; 64\] = \[(.*?)\];", text, re.S)[1]
    known = {
        "f64::EPSILON": math.ulp(1.0),
        "1.0 - f64::EPSILON / 2.0": math.nextafter(1.0, 0.0),
        "1.0 + f64::EPSILON": math.nextafter(1.0, 2.0),
        "std::f64::consts::PI": math.pi,
        "f64::MIN_POSITIVE": 2.0**-1022,
        "f64::MAX": math.nextafter(math.inf, 0.0),
    }
    words = [word.strip() for word in text.split(",") if word.strip()]
    return [known[word] if word in known else float(word.replace("_", "")) for word in words]


NUMBERS = table()
assert len(NUMBERS) == 64


def number(value):
    value = float(value)
    if value.is_integer() and -32 <= value < 32:
        return bytes([int(value) + 32])
    if abs(value) in NUMBERS:
        return bytes([NUMBERS.index(abs(value)) + (64 if value > 0 else 128)])
    return b"\xe0" + struct.pack("<d", value)


def vector(values):
    return b"".join(map(number, values))


def velocity(beta=None, rapidity=None, gamma=None, one_minus_beta=None, direction=(1, 0, 0), form=None):
    if form == 0:
        return bytes([0])
    given = {2: beta, 3: rapidity, 4: gamma, 5: one_minus_beta}
    ((form, speed),) = [(form, speed) for form, speed in given.items() if speed is not None]
    return bytes([form]) + number(speed) + vector(direction)


def tolerance(given):
    if given is None:
        return bytes([0])
    unit, value = given
    return bytes([1 + ["relative", "absolute", "angle_deg"].index(unit)]) + number(value)


def thing(kind="mesh", numbers=(), position=(0, 0, 0), speed=REST, scale=None, own_tolerance=None, counts=()):
    """An object; `speed` is "observer" where it moves as the observer does."""
    shape = kind != "mesh"
    out = bytes([list(SHAPES).index(kind) if shape else 8]) + vector(position)
    out += bytes([1]) if speed == "observer" else bytes([2]) + velocity(**speed)
    out += bytes([0]) if scale is None else bytes([3]) + vector(scale)
    out += bytes([0]) + tolerance(own_tolerance)
    if kind == "lattice":
        return out + bytes([2]) + vector(numbers) + bytes([0])
    out += vector(numbers)
    if kind == "grid":
        out += bytes([3])
    return out + (bytes([3]) if shape else b"")


def surface(mesh):
    corners, faces = mesh
    out = bytes([len(corners) - 3]) + b"".join(map(vector, corners)) + bytes([len(faces) - 1])
    for face, indices in enumerate(faces):
        out += bytes((index - 2 - face - corner) % len(corners) for corner, index in enumerate(indices))
    return out


def case(
    things,
    speed=REST,
    place=(0, 0, 0),
    time=0,
    marker=None,
    file="glb",
    animate=None,
    subdivide=True,
    budget=2040,
    attributes=0,
    asked=None,
    steps=(0,),
    mesh=TRIANGLE,
    look=(0, 0, -1),
    fov=60,
    outside=None,
    by_mesh=False,
):
    out = bytes([["glb", "gltf", "ply"].index(file), [None, "frames", "morph"].index(animate)])
    out += bytes([0 if subdivide else 7, budget // 8])
    out += bytes([0x57, 0]) + number(fov) + vector(look)
    out += bytes([0]) if outside is None else bytes([2]) + vector(outside)
    out += bytes([by_mesh, 0, attributes])
    out += number(time) + vector(place) + velocity(**speed)
    out += bytes([0]) if marker is None else bytes([3]) + number(marker)
    out += tolerance(asked) + bytes([len(steps) - 1]) + b"".join(map(number, steps))
    return out + bytes([len(things) - 1]) + b"".join(things) + surface(mesh)


FAST = dict(beta=0.9, direction=(0, 0, -1))
OBLIQUE = (1, 2, 3)
ALL = 7


def shapes():
    sizes = {"sphere": [1], "box": [1, 2, 1], "cylinder": [1, 2], "cone": [1, 2], "torus": [2, 1], "rod": [10, 0.1]}
    sizes |= {"grid": [4], "lattice": [1, 0.1]}
    for index, (kind, numbers) in enumerate(sizes.items()):
        yield kind, case(
            [thing(kind, numbers, (0.5, 0, -5))],
            FAST,
            file=["glb", "gltf", "ply"][index % 3],
            attributes=index,
            outside=(3, 3, 3) if index % 2 else None,
        )


def faults():
    """What once went wrong, each by a name that says what it is."""
    for name, speed in {
        "beta_08": dict(beta=0.8),
        "beta_095": dict(beta=0.95),
        "gamma_10": dict(gamma=10),
        "gamma_1e6": dict(gamma=1e6, direction=OBLIQUE),
    }.items():
        yield f"equal_velocities_{name}", case([thing("sphere", [1], (3, 0, -5), "observer")], speed)
    yield "marker_1e70", case([thing()], FAST, marker=1e70)
    yield "marker_1e-65", case([thing()], FAST, marker=1e-65)
    yield "in_the_plane_angle", case(
        [thing()], dict(beta=0.9), (0.13, 0, -0.21), mesh=PLATE, asked=("angle_deg", 0.01)
    )
    yield "angle_morph_triangle", case(
        [thing()], dict(rapidity=20, direction=OBLIQUE), asked=("angle_deg", 1), steps=(-1, 0, 2), animate="morph"
    )
    yield "angle_morph_cube", case(
        [thing("box", [2, 2, 2], (0, 0, -5))], dict(gamma=1000), asked=("angle_deg", 1), steps=(-6, 0, 6), animate="morph"
    )
    yield "far_steps_fine_tolerance", case(
        [thing()],
        dict(rapidity=35.69),
        mesh=SQUARE,
        asked=("relative", 1.0004e-8),
        steps=(-51450, 0, 3939621),
        animate="frames",
    )
    yield "far_time_wide_angle", case(
        [thing()],
        dict(rapidity=30.24),
        time=-2.19e22,
        mesh=SQUARE,
        asked=("angle_deg", 45.9),
        steps=(-1, 1),
        budget=0,
        animate="frames",
    )
    yield "at_rest_in_scaled_object", case(
        [thing("sphere", [1], scale=(1, 2, 0.25))], attributes=ALL, asked=("angle_deg", 0.1), file="ply"
    )
    yield "vanishing_triangles_cube", case(
        [thing("box", [2, 2, 2], (0, 0, -5))], dict(rapidity=20, direction=(0, 0, -1)), steps=(5,), attributes=4, file="ply"
    )
    yield "vanishing_triangle", case(
        [thing(position=(0, 0, -5))], dict(rapidity=20, direction=(0, 0, -1)), steps=(5,), file="ply"
    )
    yield "least_tolerance", case([thing("box", [1, 1, 1], (0, 0, -5))], FAST, asked=("relative", 5e-324))
    yield "box_at_1e18", case([thing("box", [1, 1, 1], (1e18, 0, -1e18))], FAST, file="ply")
    yield "rapidity_350", case(
        [thing("sphere", [1], (0, 0, -5)), thing("box", [1, 1, 1], (3, 0, -5))],
        dict(rapidity=350, direction=OBLIQUE),
        steps=(0, 2.5, 5),
        file="ply",
        by_mesh=True,
        outside=(3, 3, 3),
    )
    yield "extremes_of_the_minimum", case([thing(scale=(1e75, 1e75, 1e75))], FAST, asked=("absolute", 1e-75), file="ply")


def embedded(content, kind="application/octet-stream"):
    return f"data:{kind};base64,{base64.b64encode(content).decode()}"


def gltf(**changes):
    """A triangle, with other values for some keys; None takes a key out."""
    data = struct.pack("<9f", 0, 0, 0, 1, 0, 0, 0, 1, 0) + struct.pack("<4H", 0, 1, 2, 0)
    document = {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"},
            {"bufferView": 1, "componentType": 5123, "count": 3, "type": "SCALAR"},
        ],
        "bufferViews": [
            {"buffer": 0, "byteOffset": 0, "byteLength": 36},
            {"buffer": 0, "byteOffset": 36, "byteLength": 6},
        ],
        "buffers": [{"uri": embedded(data), "byteLength": len(data)}],
    } | changes
    return json.dumps({key: value for key, value in document.items() if value is not None}).encode()


def with_accessor(**accessor):
    """The triangle, whose positions are another accessor."""
    usual = json.loads(gltf())["accessors"]
    return gltf(accessors=[{"componentType": 5126, "count": 3, "type": "VEC3"} | accessor, usual[1]])


def with_few_values(accessor):
    """An accessor of zeros but for the corners of the triangle."""
    indices = {"bufferView": 1, "componentType": 5123}
    return accessor | {"sparse": {"count": 3, "indices": indices, "values": {"bufferView": 0}}}


def glb(document, data=b"", declared=None):
    document += b" " * (-len(document) % 4)
    chunks = struct.pack("<I4s", len(document), b"JSON") + document
    if data:
        chunks += struct.pack("<I4s", len(data), b"BIN\0") + data
    return struct.pack("<4sII", b"glTF", 2, declared or 12 + len(chunks)) + chunks


def gltf_files():
    yield "triangle.gltf", gltf()
    yield "triangle.glb", glb(gltf())
    yield "longer_than_it_is.glb", glb(gltf(), declared=0xFFFFFFF0)
    yield "ends_in_the_header.glb", glb(gltf())[:17]
    yield "no_buffer_view_huge_count.gltf", with_accessor(count=400_000_000)
    yield "sparse_huge_count.gltf", with_accessor(**with_few_values({"count": 400_000_000}))
    zeros = {"componentType": 5126, "count": 16_000_000, "type": "VEC2"}
    places = with_few_values({"componentType": 5126, "count": 16_000_000, "type": "VEC3"})
    primitive = {"attributes": {"POSITION": 0} | {f"TEXCOORD_{i}": 2 for i in range(60)}, "indices": 1}
    triangle = json.loads(gltf())["accessors"][1]
    yield "sixty_sets_of_zeros.gltf", gltf(
        accessors=[places, triangle, zeros], meshes=[{"primitives": [primitive]}]
    )
    chain = [{"children": [node + 1]} for node in range(60)] + [{"mesh": 0}]
    yield "deep.gltf", gltf(nodes=chain)
    yield "its_own_child.gltf", gltf(nodes=[{"mesh": 0, "children": [0]}])
    yield "child_twice.gltf", gltf(nodes=[{"children": [1, 1]}, {"mesh": 0}])
    doubling = [{"children": [node + 1, node + 1]} for node in range(40)] + [{"mesh": 0}]
    yield "doubling.gltf", gltf(nodes=doubling)
    yield "nested_arrays.gltf", b'{"asset":' + b"[" * 3000
    yield "scene_of_no_nodes.gltf", gltf(scenes=[{}])
    yield "matrix.gltf", gltf(nodes=[{"mesh": 0, "matrix": [2, 0, 0, 0, 0, 0, 1, 0, 0, -1, 0, 0, 5, 6, 7, 1]}])
    yield "flat_scale.gltf", gltf(nodes=[{"mesh": 0, "scale": [1, 1, 0]}])
    yield "far_scale.gltf", gltf(nodes=[{"mesh": 0, "scale": [1e38, 1e38, 1e38]}])
    yield "instances.gltf", gltf(
        extensionsUsed=["EXT_mesh_gpu_instancing"],
        nodes=[
            {"mesh": 0, "extensions": {"EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": 2, "SCALE": 2}}}}
        ],
        accessors=json.loads(gltf())["accessors"]
        + [{"componentType": 5126, "count": 100_000_000, "type": "VEC3"}],
    )
    yield "skin.gltf", gltf(
        nodes=[{"mesh": 0, "skin": 0}, {"rotation": [0, 0, 1, 0]}],
        scenes=[{"nodes": [0, 1]}],
        skins=[{"joints": [1]}],
        meshes=[
            {
                "primitives": [{"attributes": {"POSITION": 0, "JOINTS_0": 2, "WEIGHTS_0": 3}}],
            }
        ],
        accessors=json.loads(gltf())["accessors"]
        + [
            {"componentType": 5121, "count": 3, "type": "VEC4"},
            {"componentType": 5126, "count": 3, "type": "VEC4"},
        ],
    )
    yield "morph.gltf", gltf(
        meshes=[
            {
                "weights": [0.5],
                "primitives": [{"attributes": {"POSITION": 0}, "targets": [{"POSITION": 0, "NORMAL": 0}]}],
            }
        ]
    )
    yield "textured.gltf", gltf(
        materials=[
            {
                "pbrMetallicRoughness": {
                    "baseColorTexture": {"index": 0, "extensions": {"KHR_texture_transform": {"scale": [2, 2]}}}
                },
                "alphaMode": "MASK",
            }
        ],
        textures=[{"source": 0, "sampler": 0}],
        samplers=[{"wrapS": 33648, "magFilter": 9728}],
        images=[{"uri": embedded(b"\x89PNG\r\n\x1a\n", "image/png")}],
        meshes=[{"primitives": [{"attributes": {"POSITION": 0, "TEXCOORD_0": 2}, "material": 0}]}],
        accessors=json.loads(gltf())["accessors"] + [{"componentType": 5126, "count": 3, "type": "VEC2"}],
    )
    for name, uri in {
        "parent": "../../../../../../../../etc/passwd",
        "parent_encoded": "..%2f..%2f..%2f..%2fetc%2fpasswd",
        "absolute": "/etc/passwd",
        "file": "file:///etc/passwd",
        "device": "/dev/zero",
        "truncated_data": "data:application/octet-stream;base64,AAA",
    }.items():
        yield f"uri_{name}.gltf", gltf(buffers=[{"uri": uri, "byteLength": 44}])


TRIANGLE_OBJ = "v 0 0 0\nv 1 0 0\nv 0 1 0\n"


def obj_files():
    """OBJ and MTL, a zero byte between them."""
    ring = range(1, 201)
    circle = [(math.cos(i), math.sin(i), 0) for i in (math.tau * (corner - 1) / 200 for corner in ring)]
    star = [(x * (1 + corner % 2), y * (1 + corner % 2), 0) for corner, (x, y, _) in enumerate(circle)]
    lines = lambda places: "".join("v %.4g %.4g %.4g\n" % place for place in places)
    face = "f " + " ".join(map(str, ring)) + "\n"
    library = "newmtl red\nKd 1 0 0\nNs 10\nd 0.5\nmap_Kd -s 2 2 1 -o 0 0 red.png\nbump -bm 2 bump.png\n"
    textured = "mtllib a.mtl\n" + TRIANGLE_OBJ + "vt 0 0\nvn 0 0 1\nusemtl red\nf 1/1/1 2/1/1 3/1/1\n"
    yield "textured", textured + "\0" + library
    yield "library_is_itself", textured.replace("a.mtl", "a.obj")
    yield "library_is_a_device", textured.replace("a.mtl", "/dev/zero")
    yield "library_many_times", "mtllib a.mtl\n" * 200 + textured + "\0" + library
    yield "circle", lines(circle) + face
    yield "star", lines(star) + face
    yield "byte_order_mark", "\ufeff" + TRIANGLE_OBJ + "f 1 2 3\n"
    yield "carriage_returns", (TRIANGLE_OBJ + "f 1 2 3\n").replace("\n", "\r")
    yield "continued", TRIANGLE_OBJ + "f 1 \\\n2 \\\n3\n"
    yield "from_the_end", TRIANGLE_OBJ + "f -3 -2 -1\nf -1 -2 -9223372036854775808\n"
    yield "beyond", TRIANGLE_OBJ + "f 1 2 18446744073709551615\nf 0 1 2\n"
    yield "same_corner", TRIANGLE_OBJ + "f 1 1 1\nf 1 2\nf 1\nf\n"
    yield "mixed", TRIANGLE_OBJ + "vt 0 0\nvn 0 0 1\nf 1/1 2//1 3/1/1\nf 1/ 2/ 3/\nf 1// 2// 3//\n"
    yield "colors", "v 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 0 1 0 0 0 1\nv 0 0 1 1\nf 1 2 3\n"
    yield "no_numbers", "v nan 0 0\nv inf 0 0\nv 1e400 0 0\nvn nan nan nan\nf 1 2 3\n"
    yield "groups", TRIANGLE_OBJ + "g a b\no c\ns off\nusemtl #ff0000\nf 1 2 3\nusemtl other\nf 1 2 3\n"
    yield "curves", TRIANGLE_OBJ + "cstype bezier\ndeg 2\ncurv 0 1 1 2 3\nend\np 1\nl 1 2\nf 1 2 3\n"


def scan_files():
    """PLY, STL and OFF, which their first bytes tell apart."""
    corners = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)]
    vertex = "element vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
    face = "element face 1\nproperty list uchar int vertex_indices\n"
    ply = lambda order, elements: f"ply\nformat {order} 1.0\n{elements}end_header\n".encode()
    places = b"0 0 0\n1 0 0\n1 1 0\n0 1 0\n"
    yield "text.ply", ply("ascii", vertex + face) + places + b"4 0 1 2 3\n"
    for order, sign in {"little": "<", "big": ">"}.items():
        data = b"".join(struct.pack(sign + "3f", *corner) for corner in corners) + struct.pack(sign + "B4i", 4, 0, 1, 2, 3)
        yield f"{order}.ply", ply(f"binary_{order}_endian", vertex + face) + data
        yield f"{order}_cut_off.ply", ply(f"binary_{order}_endian", vertex + face) + data[:-3]
    everything = "".join(
        f"property {kind} {name}\n"
        for kind, name in [("double", "nx"), ("double", "ny"), ("double", "nz"), ("uchar", "red"), ("ushort", "green")]
        + [("float", "blue"), ("char", "alpha"), ("float", "s"), ("float", "t"), ("int", "other")]
    )
    numbers = b"0 0 1 255 65535 0.5 127 0.25 0.75 -1\n"
    lines = b"".join(place + b" " + numbers for place in places.splitlines())
    yield "everything.ply", ply("ascii", vertex + everything + face) + lines + b"4 0 1 2 3\n"
    strips = "element tristrips 1\nproperty list int int vertex_indices\n"
    yield "strips.ply", ply("ascii", strips + vertex) + b"8 0 1 3 2 -1 0 1 2\n" + places
    yield "cloud.ply", ply("ascii", vertex) + places
    yield "huge_counts.ply", ply("binary_little_endian", (vertex + face).replace(" 4", " 4000000000")) + places
    yield "huge_count_of_nothing.ply", ply("ascii", "element nothing 18446744073709551615\n" + vertex + face) + places
    long_list = "element face 1\nproperty list uint double vertex_index\n"
    yield "huge_list.ply", ply("binary_little_endian", long_list) + b"\xff\xff\xff\xff" + places
    yield "float_list.ply", ply("ascii", vertex + face.replace("uchar int", "float double")) + places + b"1e9 0 1 2 3\n"
    yield "carriage_returns.ply", (ply("ascii", vertex + face) + places + b"4 0 1 2 3\n").replace(b"\n", b"\r")

    facet = struct.pack("<12fH", 0, 0, 1, *corners[0], *corners[1], *corners[2], 0)
    stl = lambda start, count, data: start.ljust(80) + struct.pack("<I", count) + data
    yield "binary.stl", stl(b"", 1, facet)
    yield "binary_solid.stl", stl(b"solid a", 2, facet + facet[:-2] + b"\x1f\x80")
    yield "binary_cut_off.stl", stl(b"", 0xFFFFFFFF, facet)
    yield "binary_without_area.stl", stl(b"", 1, struct.pack("<12fH", *[0] * 13))
    text = "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n"
    yield "text.stl", f"solid a\n{text}endsolid a\nsolid b\n{text}endsolid\n".encode()
    yield "ends_early.stl", f"solid a\n{text[:50]}".encode()

    square = "4 1 4\n0 0 0{0}\n1 0 0{0}\n1 1 0{0}\n0 1 0{0}\n4 0 1 2 3 255 0 0\n"
    yield "plain.off", ("OFF\n" + square.format("")).encode()
    yield "everything.off", ("STCNOFF\n" + square.format(" 0 0 1 255 0 0 255 0.5 0.5")).encode()
    yield "no_space.off", ("OFF" + square.format("")).encode()
    yield "binary.off", b"OFF BINARY\n" + bytes(40)
    yield "huge_counts.off", b"OFF\n4294967296 18446744073709551615 0\n0 0 0\n"
    yield "huge_face.off", ("OFF\n" + square.format("").replace("4 0 1", "4294967295 0 1")).encode()


def scenes():
    one = '{"objects":[{"name":"a","shape":'
    sphere = '{"sphere":{"radius":1}}'
    yield "sphere.json", one + sphere + "}]}"
    for name, shape in {
        "box": '{"box":{"size":[1,2,3],"resolution":4}}',
        "cylinder": '{"cylinder":{"radius":1,"height":2}}',
        "cone": '{"cone":{"radius":1,"height":2}}',
        "torus": '{"torus":{"major_radius":2,"minor_radius":1}}',
        "rod": '{"rod":{"length":10,"radius":0.1}}',
        "grid": '{"grid":{"size":10,"cells":10}}',
        "lattice": '{"lattice":{"cells":4,"spacing":1,"thickness":0.1}}',
    }.items():
        yield f"{name}.json", one + shape + "}]}"
    yield "all.json", json.dumps(
        {
            "title": "all",
            "observer": {
                "time": 1,
                "position": [1, 2, 3],
                "velocity": {"gamma": 2, "direction": [1, 1, 0]},
                "marker": 0.1,
            },
            "steps": {"from": -1, "to": 1, "count": 3},
            "tolerance": {"angle_deg": 0.1},
            "attributes": ["doppler", "emission_time", "rest_position"],
            "objects": [
                {
                    "name": "a",
                    "file": "a.obj",
                    "scale": [1, 2, 3],
                    "rotation": [0, 0, 0, 1],
                    "position": [0, 0, -5],
                    "velocity": [0.1, 0.2, 0.3],
                    "tolerance": {"absolute": 0.01},
                }
            ],
        }
    )
    yield "flight.json", json.dumps(
        {
            "units": {"length_m": 299792458},
            "observer": {
                "orientation": {"look": [1, 0, 0], "up": [0, 1, 0]},
                "flight": [
                    {"proper_time": 1, "acceleration": [1, 2, 3], "turn_rate": [4, 5, 6], "steer": "free"},
                    {"proper_time": 2, "acceleration_g": [0, 0, -1]},
                    {"proper_time": 3, "acceleration": [0.1, 0, -0.1], "steer": "coordinated"},
                ],
                "integrator": {"rk4": 0.1},
            },
            "steps": [0, 3, 7],
            "objects": [{"name": "a", "shape": {"sphere": {"radius": 1}}}],
        }
    )
    yield "most_steps.json", one + sphere + '}],"steps":{"from":0,"to":1,"count":100000}}'
    yield "too_many_steps.json", one + sphere + '}],"steps":{"from":0,"to":1,"count":18446744073709551615}}'
    yield "even_overflow.json", one + sphere + '}],"steps":{"from":-1.7e308,"to":1.7e308,"count":3}}'
    yield "numbers.json", one + sphere + ',"position":[1e999,-1e-999,1e308],"velocity":{"one_minus_beta":5e-324}}]}'
    yield "turned.json", one + sphere + ',"rotation":[1e200,1e200,0,0]}]}'
    yield "nested.json", "[" * 3000
    yield "huge_counts.json", one + '{"grid":{"size":10,"cells":4294967295,"resolution":4294967295}}}]}'


def main():
    inputs = {
        "gltf": gltf_files(),
        "obj": ((name, text.encode()) for name, text in obj_files()),
        "scan": scan_files(),
        "scene": ((name, text.encode()) for name, text in scenes()),
        "export": [*shapes(), *faults()],
        "render": [*shapes(), *faults()],
    }
    for target, files in inputs.items():
        folder = HERE / "corpus" / target
        folder.mkdir(parents=True, exist_ok=True)
        for name, content in files:
            (folder / name).write_bytes(content)


if __name__ == "__main__":
    main()
