"""Blender reads from every kind of file what the file's own JSON says is there, and shows it."""

import io
import json

import numpy
import pytest
from PIL import Image

import blender
import glb
import handmade
from kinds import FRAMES_PER_SECOND, KINDS, PLAYING
from scenes import CUBE


@pytest.fixture(params=KINDS)
def paths(request, export, tmp_path):
    """The files of a kind."""
    return KINDS[request.param](export, tmp_path)


def each_mesh(paths):
    """Each node of the files with the object that it is in Blender."""
    for path in paths:
        document = glb.Gltf(path)
        objects = blender.open_file(path)
        assert sorted(objects) == sorted(node.name for node in document.nodes)
        for node in document.nodes:
            yield document, node, objects[node.name]


@pytest.fixture(scope="session")
def flyby(photosurface, export):
    """The file of the built-in scene with seven steps."""
    return export(json.loads(photosurface("example", "sphere")))


def test_the_outliner_shows_the_steps(flyby):
    objects = blender.open_file(flyby)
    assert sorted(objects) == ["observer", *(f"sphere_step{step:03}" for step in range(7))]
    for name, found in objects.items():
        assert found.data.name == name
        # All of a step is one thing to hide or to move.
        parent = None if name == "observer" else name.removeprefix("sphere_")
        assert (found.parent and found.parent.name) == parent
    # A file of this kind is meshes and their steps, nothing else.
    assert len(blender.bpy.data.objects) == len(objects) + 7


def test_meshes_are_those_of_the_file(paths):
    """Names, and every vertex and face, in the order of the file."""
    for _, node, found in each_mesh(paths):
        assert found.data.name == node.mesh["name"]
        assert len(found.data.vertices) == len(node.positions)
        assert blender.triangles(found).tolist() == node.triangles.tolist()


@pytest.mark.parametrize("paths", [kind for kind in KINDS if kind not in PLAYING], indirect=True)
def test_places_are_those_of_the_file(paths):
    """Evaluated as for the viewport. Blender holds a translation in f32, and rounds no vertex."""
    for _, node, found in each_mesh(paths):
        error = abs(blender.places(found) - node.world)
        assert (error <= 2**-24 * abs(node.translation) + 2**-52 * abs(node.world)).all()


@pytest.mark.parametrize("kind", PLAYING)
def test_each_frame_shows_its_step(kind, export, tmp_path):
    """As the dependency graph has it; a mesh for each step stays until the next."""
    (path,) = PLAYING[kind](export, tmp_path)
    document = glb.Gltf(path)
    objects = blender.open_file(path)
    for step in range(7):
        expected = document.at_step(step)
        for part in [0] if any(node.targets for node in document.nodes) else [0, 0.5]:
            found = blender.shown(objects, (step + part) / FRAMES_PER_SECOND)
            assert found.keys() == expected.keys()
            for name, places in expected.items():
                (node,) = [node for node in document.nodes if node.name == name]
                # The translation in f32; of shape keys the sum, its difference from the base, and both together.
                local = numpy.abs([node.positions, *(t["POSITION"] for t in node.targets)]).max(axis=0)
                limit = 2**-24 * abs(node.translation) + 2**-52 * abs(places)
                if node.targets:
                    limit = limit + 2**-24 * 8 * local
                assert (abs(found[name] - places) <= limit).all(), (step, part, name)


def test_normals_are_those_of_the_file(paths):
    """Blender keeps normals as two angles in a frame of their corner, and takes such an angle for nothing, or two
    normals for one, where their cosine is above 1 - 1e-4 (its LNOR_SPACE_TRIGO_THRESHOLD)."""
    for _, node, found in each_mesh(paths):
        corners = blender.to_gltf(blender.values(found.data.corner_normals, "vector", 3))
        expected = node.attributes["NORMAL"][node.triangles.ravel()].astype(float)
        assert numpy.linalg.norm(corners - expected, axis=1).max() <= numpy.arccos(1 - 1e-4)


def test_texture_coordinates_are_those_of_the_file(paths):
    for _, node, found in each_mesh(paths):
        names = sorted(name for name in node.attributes if name.startswith("TEXCOORD_"))
        layers = found.data.uv_layers
        assert len(layers) == len(names)
        for name, layer in zip(names, layers, strict=True):
            u, v = node.attributes[name][node.triangles.ravel()].astype(float).T
            # Blender counts v from below; 1 - v is rounded to f32.
            found_uv = blender.values(layer.uv, "vector", 2)
            assert found_uv[:, 0].tolist() == u.tolist()
            assert abs(found_uv[:, 1] - (1 - v)).max() <= 2**-24 * abs(1 - v).max()


def test_attributes_are_those_of_the_file(paths):
    for _, node, found in each_mesh(paths):
        assert_attributes_arrive(node, found)


def assert_attributes_arrive(node, found):
    for name, values in node.attributes.items():
        if name.startswith("_"):
            assert blender.attribute(found, name).tolist() == values.tolist(), name


def test_facts_are_custom_properties(paths):
    for document, node, found in each_mesh(paths):
        (scene,) = document.json["scenes"]
        assert properties(blender.bpy.context.scene).items() >= scene.get("extras", {}).items()
        assert properties(found) == node.json.get("extras", {})


def properties(owner):
    """The custom properties as JSON would have them."""
    return {key: plain(value) for key, value in owner.items()}


def plain(value):
    if hasattr(value, "to_dict"):
        return value.to_dict()
    if hasattr(value, "to_list"):
        return value.to_list()
    return [plain(item) for item in value] if isinstance(value, list) else value


def test_materials_are_those_of_the_file(paths):
    for document, node, found in each_mesh(paths):
        surface = node.material.get("pbrMetallicRoughness", {})
        shader, image = blender.surface(found)
        assert found.material_slots[0].material.use_backface_culling != node.material.get("doubleSided", False)
        assert shader.inputs["Metallic"].default_value == surface.get("metallicFactor", 1)
        assert shader.inputs["Roughness"].default_value == pytest.approx(
            surface.get("roughnessFactor", 1), rel=2**-24
        )
        texture = surface.get("baseColorTexture")
        if "COLOR_0" in node.attributes:
            # The base colour comes from there: `test_colours_of_vertices_are_what_the_material_shows`.
            assert image is None and texture is None
            assert surface.get("baseColorFactor", [1, 1, 1, 1]) == [1, 1, 1, 1]
        elif texture is None:
            assert image is None
            written = surface.get("baseColorFactor", [1, 1, 1, 1])
            *colour, _ = shader.inputs["Base Color"].default_value
            assert colour == pytest.approx(written[:3], rel=2**-24)
            assert shader.inputs["Alpha"].default_value == pytest.approx(written[3], rel=2**-24)
        else:
            picture = numpy.asarray(Image.open(io.BytesIO(document.picture(texture))).convert("RGBA"))
            assert image.packed_file is not None
            assert image.colorspace_settings.name == "sRGB"
            assert blender.pixels(image).tolist() == picture.tolist()


def test_pictures_are_looked_at_in_some_kind(export, tmp_path):
    """Else the test above would say nothing of them."""
    (path,) = KINDS["hierarchy with a texture"](export, tmp_path)
    images = [blender.surface(found)[1] for found in blender.open_file(path).values()]
    assert sorted(tuple(image.size) for image in images if image) == [(8, 4)] * 4
    assert images.count(None) == 2


def test_ply_brings_the_doppler_factor(export):
    """As the attribute `quality`, by which the surface can be painted."""
    document = glb.Gltf(export(CUBE))
    (found,) = blender.open_file(export(CUBE, to="out.ply")).values()
    world = numpy.concatenate([node.world for node in document.nodes])
    # A PLY file says nothing of axes: Blender takes them as they are.
    places = blender.values(found.data.vertices, "co", 3)
    assert abs(places - world).max() <= 2 * 2**-24 * abs(world).max()
    assert blender.attribute(found, "quality").min() > 0


# Pictures.

ENGINES = ["CYCLES", "BLENDER_WORKBENCH"]


def look_from_outside(objects):
    """At right angles to the flight, from far enough for all of it."""
    world = numpy.concatenate([blender.places(found) for found in objects.values()])
    low, high = world.min(axis=0), world.max(axis=0)
    middle = (low + high) / 2
    blender.camera(middle + [0, 0, 100], [0, 0, -1], width=1.05 * (high - low)[0])
    blender.light()


@pytest.mark.parametrize("engine", ENGINES)
def test_a_picture_shows_what_is_shown(engine, flyby, tmp_path):
    objects = blender.open_file(flyby)
    look_from_outside(objects)

    def picture(*names):
        blender.show_only(objects, names)
        path = tmp_path / f"{engine}_{len(names)}.png"
        return blender.render(path, (640, 128), engine)

    everything = picture(*objects)
    one = picture("sphere_step003")
    nothing = picture()
    assert not nothing.any()
    visible, visible_one = everything[..., 3] > 0.5, one[..., 3] > 0.5
    assert 100 < visible_one.sum() < visible.sum()
    assert visible[visible_one].all()
    # Light falls on it: neither black nor all of one colour.
    colours = everything[visible][:, :3]
    assert colours.max() > 0.5
    assert len(numpy.unique(colours.round(1), axis=0)) > 5


@pytest.mark.parametrize("kind", PLAYING)
def test_pictures_of_frames_show_their_steps(kind, export, tmp_path):
    """What is drawn at a frame fills the box around that step's vertices, to a pixel and a half."""
    (path,) = PLAYING[kind](export, tmp_path)
    document = glb.Gltf(path)
    objects = blender.open_file(path)
    things = [name for name in objects if name != "observer"]
    blender.show_only(objects, things)
    steps = [document.at_step(step) for step in range(7)]
    steps = [numpy.concatenate([step[name] for name in things if name in step]) for step in steps]
    # Along no axis, for some of these meshes are flat.
    width, height = 800, 600
    every = numpy.concatenate(steps)
    middle = (every.min(axis=0) + every.max(axis=0)) / 2
    extent = 2.1 * numpy.linalg.norm(every - middle, axis=1).max()
    forward = numpy.array([-1, -0.5, -2]) / 5.25**0.5
    seen = blender.camera(middle - 100 * forward, forward, width=extent)
    blender.light()
    blender.bpy.context.view_layer.update()
    axes = numpy.array(seen.matrix_world.to_3x3()).T[:2]
    pixel = extent / width
    boxes = []
    for step, places in enumerate(steps):
        blender.shown(objects, step / FRAMES_PER_SECOND)
        picture = blender.render(tmp_path / f"{step}.png", (width, height), "BLENDER_WORKBENCH")
        rows, columns = numpy.nonzero(picture[..., 3] > 0.25)
        assert len(rows) > 50
        x, y = axes @ numpy.array([blender.to_blender(place - middle) for place in places]).T / pixel
        expected = [x.min() + width / 2, x.max() + width / 2, height / 2 - y.max(), height / 2 - y.min()]
        boxes.append([columns.min(), columns.max() + 1, rows.min(), rows.max() + 1])
        assert boxes[-1] == pytest.approx(expected, abs=1.5)
    assert len(set(map(tuple, boxes))) == len(boxes)


def test_the_observer_sees_a_circle(flyby, tmp_path):
    """From the observer's place an ordinary camera sees the sphere as Penrose (1959) says: with a circular outline.

    Moving at beta = 0.95 along +x, its centre at rest at (0, 3, 0): cot psi = gamma cos psi' / sin psi' gives
    the circle's angular radius and tan theta = -sin theta' / (gamma beta cos psi') its axis, from +x.
    """
    beta, distance, radius = 0.95, 3, 1
    gamma = (1 - beta**2) ** -0.5
    sin_rest = radius / distance
    cos_rest = (1 - sin_rest**2) ** 0.5
    psi = numpy.arctan2(sin_rest, gamma * cos_rest)
    theta = numpy.arctan2(1, -gamma * beta * cos_rest)
    assert numpy.degrees([psi, theta]) == pytest.approx([6.29977261497, 160.780314124], abs=1e-9)
    axis = numpy.array([numpy.cos(theta), numpy.sin(theta), 0])

    objects = blender.open_file(flyby)
    (step,) = [name for name, found in objects.items() if found.get("proper_time") == 0]
    blender.show_only(objects, [step])
    # The circle is not in the middle: what is up and what is left matter.
    size, fov_deg = 200, 20
    forward = axis + [0.01, 0.02, 0.03]
    seen = blender.camera([0, 0, 0], forward, fov_deg=fov_deg)
    alpha = blender.render(tmp_path / "observer.png", (size, size))[..., 3]

    # The ray through the middle of each pixel, in the axes of the camera, then of the world.
    across = (2 * (numpy.arange(size) + 0.5) / size - 1) * numpy.tan(numpy.radians(fov_deg) / 2)
    x, y = numpy.meshgrid(across, -across)
    rays = numpy.stack([x, y, -numpy.ones_like(x)], axis=-1)
    rays = blender.to_gltf((rays @ numpy.array(seen.matrix_world.to_3x3()).T).reshape(-1, 3))
    rays /= numpy.linalg.norm(rays, axis=1)[:, None]
    outside = numpy.arccos(rays @ axis).reshape(size, size) - psi

    # Half a pixel's diagonal about its middle, as much for Blender's filter of the width of 1.5 pixels, and
    # what the certificate allows at the distance at which the outline is seen, at least.
    pixel = 2 * numpy.tan(numpy.radians(fov_deg) / 2) / size
    nearest = numpy.linalg.norm(blender.places(objects[step]), axis=1).min()
    unsure = 2 * 0.75 * 2**0.5 * pixel + objects[step]["certificate"]["total"] / nearest
    assert unsure < psi / 10
    assert (alpha[outside > unsure] == 0).all()
    assert (alpha[outside < -unsure] == 1).all()


def test_an_attribute_paints(photosurface, export, tmp_path):
    """What approaches is bright, what recedes is dark: the Doppler factor in the Attribute node."""
    objects = blender.open_file(export(json.loads(photosurface("example", "sphere")), to="out.ply"))
    blender.paint_by(objects, "quality")
    (found,) = objects.values()
    # A PLY file's z is Blender's z, so that this looks at it from above.
    places = blender.values(found.data.vertices, "co", 3)
    low, high = places.min(axis=0), places.max(axis=0)
    middle = blender.to_gltf([(low + high) / 2])[0]
    blender.camera(middle + [0, 100, 0], [0, -1, 0], width=1.05 * (high - low)[0])
    picture = blender.render(tmp_path / "doppler.png", (640, 128))
    visible = picture[..., 3] == 1
    columns = numpy.where(visible.any(axis=0))[0]
    first, last = (picture[:, column][visible[:, column]][:, 0].mean() for column in columns[[2, -3]])
    assert first > 0.9
    assert last < 0.5


# What the questions about animations rest on: files made by hand, the poses of which are known.


@pytest.mark.parametrize(
    ("time", "step"), [(0, 0), (0.25, 0), (0.49, 0), (0.5, 1), (0.75, 1), (0.99, 1), (1, 2), (2, 2)]
)
def test_scale_keys_show_one_step_at_a_time(time, step, tmp_path):
    objects = blender.open_file(handmade.write_scale_keys(tmp_path))
    ((name, places),) = blender.shown(objects, time).items()
    assert name == handmade.step_name(step)
    assert places.tolist() == (handmade.STEPS[step] + handmade.TRANSLATIONS[step]).tolist()


def test_morph_targets_go_from_step_to_step(tmp_path):
    objects = blender.open_file(handmade.write_morph_targets(tmp_path))
    names = [key.name for key in objects["thing"].data.shape_keys.key_blocks]
    assert names[1:] == [handmade.step_name(1), handmade.step_name(2)]
    first, second, third = (step + handmade.TRANSLATIONS[0] for step in handmade.STEPS)
    expected = [first, (first + second) / 2, second, (second + third) / 2, third]
    for time, places in zip([0, 0.25, 0.5, 0.75, 1], expected, strict=True):
        assert abs(blender.shown(objects, time)["thing"] - places).max() <= 2**-22


def test_attributes_of_their_own_arrive(tmp_path):
    path = handmade.write_scale_keys(tmp_path)
    objects = blender.open_file(path)
    for step, node in enumerate(glb.Gltf(path).nodes):
        assert node.attributes["_HEAT"].tolist() == handmade.heat(step).tolist()
        assert_attributes_arrive(node, objects[node.name])


def test_colours_of_vertices_are_what_the_material_shows(export, tmp_path):
    """Nobody has to choose them: the base colour of the shader comes from the colours of the mesh."""
    for kind in ("Doppler colours", "Doppler colours of textures"):
        for path in KINDS[kind](export, tmp_path):
            colored = 0
            for _, node, found in each_mesh([path]):
                shader, image = blender.surface(found)
                links = shader.inputs["Base Color"].links
                written = node.attributes.get("COLOR_0")
                if written is None:
                    assert not links
                    continue
                colored += 1
                assert image is None
                assert [link.from_node.type for link in links] == ["VERTEX_COLOR"]
                (colors,) = found.data.color_attributes
                assert links[0].from_node.layer_name in ("", colors.name)
                values = blender.values(colors.data, "color", 4)
                if colors.domain == "CORNER":
                    written = written[[loop.vertex_index for loop in found.data.loops]]
                # As bytes at worst, those of sRGB, which are coarser where it is bright.
                assert abs(values - written / 255).max() < 0.01
            assert colored > 0
