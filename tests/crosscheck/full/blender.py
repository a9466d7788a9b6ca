"""Questions to Blender, which answers in this process.

Places are given with the axes of glTF: Blender maps (x, y, z) to (x, -z, y), y up to z up.
"""

import math
from pathlib import Path

import bpy
import numpy
from mathutils import Vector
from PIL import Image

IMPORTERS = {
    ".glb": bpy.ops.import_scene.gltf,
    ".gltf": bpy.ops.import_scene.gltf,
    ".ply": bpy.ops.wm.ply_import,
}


def open_file(path):
    """An empty Blender with this file imported; the objects that are meshes, by name."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    path = Path(path)
    assert IMPORTERS[path.suffix](filepath=str(path)) == {"FINISHED"}
    return {object.name: object for object in bpy.context.scene.objects if object.type == "MESH"}


def to_gltf(vectors):
    x, y, z = numpy.asarray(vectors, dtype=float).T
    return numpy.column_stack([x, z, -y])


def to_blender(vector):
    x, y, z = vector
    return Vector((x, -z, y))


def values(collection, name, width):
    """One property of everything in a collection of Blender, a row each."""
    found = numpy.empty(len(collection) * width, dtype="f4")
    collection.foreach_get(name, found)
    return found.reshape(-1, width)


def evaluated(object):
    """What the dependency graph makes of an object: with the animation of this frame, and shape keys."""
    return object.evaluated_get(bpy.context.evaluated_depsgraph_get())


def places(object):
    """The vertices in the world as they are in this frame."""
    seen = evaluated(object)
    matrix = numpy.array(seen.matrix_world)
    local = values(seen.data.vertices, "co", 3).astype(float)
    return to_gltf(local @ matrix[:3, :3].T + matrix[:3, 3])


def triangles(object):
    """The corners of the faces, which all have to be triangles."""
    mesh = object.data
    assert all(polygon.loop_total == 3 for polygon in mesh.polygons)
    found = numpy.empty(len(mesh.loops), dtype="i4")
    mesh.loops.foreach_get("vertex_index", found)
    return found.reshape(-1, 3)


def attribute(object, name):
    """A scalar attribute of the vertices."""
    found = object.data.attributes[name]
    assert (found.data_type, found.domain) == ("FLOAT", "POINT")
    return values(found.data, "value", 1)[:, 0]


def scale(object):
    """How long the three axes of an object are in the world in this frame."""
    return numpy.linalg.norm(numpy.array(evaluated(object).matrix_world)[:3, :3], axis=0)


def shown(objects, time):
    """The objects that have a size at this time of the animation, by name, with their vertices in the world."""
    scene = bpy.context.scene
    whole, part = divmod(time * scene.render.fps / scene.render.fps_base, 1)
    scene.frame_set(int(whole), subframe=part)
    return {name: places(object) for name, object in objects.items() if scale(object).min() > 0}


def surface(object):
    """The nodes of the object's only material: its principled shader, and the picture of its base colour."""
    (slot,) = object.material_slots
    nodes = slot.material.node_tree.nodes
    (shader,) = [node for node in nodes if node.type == "BSDF_PRINCIPLED"]
    pictures = []
    waiting = [shader.inputs["Base Color"]]
    while waiting:
        for link in waiting.pop().links:
            if link.from_node.type == "TEX_IMAGE":
                pictures.append(link.from_node.image)
            waiting += link.from_node.inputs
    assert len(pictures) <= 1
    return shader, pictures[0] if pictures else None


def pixels(image):
    """The pixels of a picture of 8 bits, the topmost row first."""
    width, height = image.size
    found = numpy.empty(len(image.pixels), dtype="f4")
    image.pixels.foreach_get(found)
    return numpy.rint(255 * found.reshape(height, width, -1)[::-1]).astype("u1")


def show_only(objects, names):
    for name, object in objects.items():
        object.hide_render = name not in names


def paint_by(objects, name):
    """Gives the objects the grey that an attribute says: the Attribute node, into what they emit."""
    material = bpy.data.materials.new("painted by " + name)
    nodes, links = material.node_tree.nodes, material.node_tree.links
    nodes.clear()
    source = nodes.new("ShaderNodeAttribute")
    source.attribute_name = name
    light = nodes.new("ShaderNodeEmission")
    links.new(source.outputs["Fac"], light.inputs["Color"])
    links.new(light.outputs["Emission"], nodes.new("ShaderNodeOutputMaterial").inputs["Surface"])
    for object in objects.values():
        object.data.materials.clear()
        object.data.materials.append(material)


def camera(place, direction, *, fov_deg=None, width=None):
    """Looks from this place in this direction, with this angle of view, or in parallel projection."""
    data = bpy.data.cameras.new("camera")
    if fov_deg is not None:
        data.angle = math.radians(fov_deg)
    else:
        data.type = "ORTHO"
        data.ortho_scale = width
    data.clip_start, data.clip_end = 0.01, 10_000
    object = bpy.data.objects.new("camera", data)
    object.location = to_blender(place)
    object.rotation_mode = "QUATERNION"
    object.rotation_quaternion = to_blender(direction).to_track_quat("-Z", "Y")
    bpy.context.scene.collection.objects.link(object)
    bpy.context.scene.camera = object
    return object


def light():
    """A sun from above on the left, for who looks along -z, and a little light from everywhere."""
    scene = bpy.context.scene
    sun = bpy.data.objects.new("sun", bpy.data.lights.new("sun", "SUN"))
    sun.data.energy = 2
    sun.rotation_mode = "QUATERNION"
    sun.rotation_quaternion = to_blender((0.5, -0.7, -1)).to_track_quat("-Z", "Y")
    scene.collection.objects.link(sun)
    scene.world = bpy.data.worlds.new("world")
    scene.world.node_tree.nodes["Background"].inputs["Strength"].default_value = 6


def render(path, size, engine="CYCLES", samples=8):
    """The picture that the camera takes, also written to `path`: RGBA from 0 to 1, empty where nothing is."""
    scene = bpy.context.scene
    scene.render.engine = engine
    if engine == "CYCLES":
        scene.cycles.device = "CPU"
        scene.cycles.samples = samples
        scene.cycles.use_denoising = False
    else:
        scene.display.shading.color_type = "TEXTURE"
    scene.render.film_transparent = True
    scene.render.resolution_x, scene.render.resolution_y = size
    scene.render.resolution_percentage = 100
    scene.render.image_settings.file_format = "PNG"
    scene.render.image_settings.color_mode = "RGBA"
    scene.render.dither_intensity = 0
    scene.view_settings.view_transform = "Standard"
    scene.render.filepath = str(path)
    assert bpy.ops.render.render(write_still=True) == {"FINISHED"}
    return numpy.asarray(Image.open(path).convert("RGBA")) / 255
