"""PLY, STL and OFF files that trimesh and pyvista wrote are read as what they hold."""

import numpy
import pytest
import pyvista
import trimesh

import glb

# Linear colours are written in bytes.
HALF_A_BYTE = 0.501 / 255


def made():
    """A body with normals, colours, and coordinates that are no round numbers."""
    mesh = trimesh.creation.icosphere(2)
    mesh.apply_transform(trimesh.transformations.euler_matrix(0.1, 0.7, 0.3))
    colors = numpy.random.default_rng(1).integers(0, 256, (len(mesh.vertices), 4), dtype=numpy.uint8)
    mesh.visual.vertex_colors = colors
    return mesh, colors


def read(export, path):
    """The only node of what is exported at rest, seen from the origin."""
    out = export(path, "--no-subdivide", "--beta", "0", "--observer", "0,0,0")
    (node,) = glb.Gltf(out).nodes
    return node, (out.parent / "messages.txt").read_text()


def facets(positions, triangles):
    return numpy.asarray(positions)[numpy.asarray(triangles)]


def check_facets(node, mesh):
    """The same facets in the same order, to the rounding of f32."""
    found, expected = facets(node.world, node.triangles), facets(mesh.vertices, mesh.faces)
    assert found.shape == expected.shape
    assert abs(found - expected).max() <= 2**-22 * abs(expected).max()


def linear(srgb):
    srgb = srgb / 255
    return numpy.where(srgb <= 0.04045, srgb / 12.92, ((srgb + 0.055) / 1.055) ** 2.4)


@pytest.mark.parametrize("encoding", ["ascii", "binary_little_endian", "binary_big_endian"])
def test_ply_of_trimesh(encoding, export, tmp_path):
    mesh, colors = made()
    path = tmp_path / "mesh.ply"
    path.write_bytes(trimesh.exchange.ply.export_ply(mesh, encoding="ascii" if encoding == "ascii" else "binary",
                                                     vertex_normal=True))
    if encoding == "binary_big_endian":
        turn(path)
    node, said = read(export, path)
    check_facets(node, mesh)
    assert node.triangles.tolist() == mesh.faces.tolist()
    assert abs(node.attributes["NORMAL"] - mesh.vertex_normals).max() < 1e-6
    found = node.attributes["COLOR_0"]
    found = found / numpy.iinfo(found.dtype).max
    assert abs(found[:, :3] - linear(colors[:, :3])).max() < HALF_A_BYTE
    assert abs(found[:, 3] - colors[:, 3] / 255).max() < 1e-6
    assert "taken as sRGB" in said


def turn(path):
    """Makes a big-endian file of a little-endian one, by the header's own types."""
    header, data = path.read_bytes().split(b"end_header\n", 1)
    sizes = {"float": 4, "uchar": 1, "int": 4, "double": 8, "float32": 4, "uint8": 1, "int32": 4, "short": 2}
    out, at, element = b"", 0, []
    elements = []
    for line in header.decode().splitlines():
        words = line.split()
        if words[0] == "element":
            elements.append((int(words[2]), element := []))
        if words[0] == "property":
            element.append([sizes[word] for word in words[1:-1] if word != "list"])
    for count, properties in elements:
        for _ in range(count):
            for kinds in properties:
                runs = [kinds[0]]
                if len(kinds) == 2:
                    runs += [kinds[1]] * int.from_bytes(data[at : at + kinds[0]], "little")
                for size in runs:
                    out += data[at : at + size][::-1]
                    at += size
    assert at == len(data)
    path.write_bytes(header.replace(b"little", b"big") + b"end_header\n" + out)


@pytest.mark.parametrize("kind", ["stl", "stl_ascii", "off"])
def test_files_without_normals(kind, export, tmp_path):
    mesh, _ = made()
    mesh.visual = trimesh.visual.ColorVisuals()
    path = tmp_path / f"mesh.{kind.split('_')[0]}"
    mesh.export(path, file_type=kind)
    node, _ = read(export, path)
    check_facets(node, mesh)
    # Flat facets, as glTF has it of a mesh without normals.
    assert len(node.positions) == 3 * len(mesh.faces)
    flat = numpy.repeat(mesh.face_normals, 3, axis=0)
    assert abs(node.attributes["NORMAL"] - flat).max() < 1e-5


@pytest.mark.parametrize("binary", [False, True])
@pytest.mark.parametrize("kind", ["ply", "stl"])
def test_files_of_pyvista(kind, binary, export, tmp_path):
    mesh = pyvista.ParametricTorus(u_res=12, v_res=9).triangulate().clean()
    path = tmp_path / f"torus.{kind}"
    mesh.save(path, binary=binary)
    node, _ = read(export, path)
    found = facets(node.world, node.triangles)
    expected = facets(mesh.points, mesh.regular_faces)
    # VTK may write the facets in another order, and text with six digits.
    order = lambda corners: numpy.sort(corners.mean(axis=1).round(4), axis=0)
    assert abs(order(found) - order(expected)).max() < 2e-4
    # The outside stays outside.
    volume = numpy.linalg.det(found).sum() / 6
    assert abs(volume - mesh.volume) < 1e-4 * mesh.volume


@pytest.mark.parametrize("kind", ["ply", "stl", "off"])
@pytest.mark.parametrize("normals", ["smooth", "smooth:180", "flat", "none"])
def test_normals_that_are_asked_for(kind, normals, export, tmp_path):
    """A box has right angles; trimesh, which averages by angle too, is asked for the normals of a ball."""
    for mesh in (trimesh.creation.box((1, 2, 3)), trimesh.creation.icosphere(2)):
        path = tmp_path / f"{len(mesh.faces)}.{kind}"
        mesh.export(path, **({"vertex_normal": False} if kind == "ply" else {}))
        flags = "--no-subdivide", "--beta", "0", "--observer", "0,0,0", "--normals", normals
        out = export(path, *flags)
        (node,) = glb.Gltf(out).nodes
        check_facets(node, mesh)
        is_box = len(mesh.faces) == 12
        count = {"smooth": 24 if is_box else len(mesh.vertices), "flat": 3 * len(mesh.faces)}
        assert len(node.positions) == count.get(normals, len(mesh.vertices))
        assert ("NORMAL" in node.attributes) == (normals != "none")
        if normals.startswith("smooth") and not is_box:
            radial = node.world / numpy.linalg.norm(node.world, axis=1)[:, None]
            found = node.attributes["NORMAL"]
            assert (found * radial).sum(axis=1).min() > numpy.cos(0.02)
            order = numpy.lexsort(node.world.round(5).T), numpy.lexsort(mesh.vertices.round(5).T)
            assert abs(found[order[0]] - mesh.vertex_normals[order[1]]).max() < 1e-5
        loaded = trimesh.load_scene(out, process=False)
        assert sum(len(part.faces) for part in loaded.geometry.values()) == len(mesh.faces)
        # The seen one has the same vertices, in a PLY too.
        seen = trimesh.load(export(path, "--no-subdivide", "--beta", "0.9", "--normals", normals, to="out.ply"), process=False)
        assert len(seen.vertices) == len(node.positions)
        assert numpy.isfinite(seen.vertices).all()
