# SPDX-License-Identifier: MIT
"""The scenes of interop.py: each function makes one in Blender's empty scene."""
import itertools
import math

import bpy
import numpy


def material(name, color=(0.8, 0.8, 0.8), roughness=1.0, metallic=0.0, specular=0.0, **inputs):
    """Diffuse unless said otherwise; `specular` is Blender's level, 0.5 for an index of 1.5."""
    made = bpy.data.materials.new(name)
    made.use_nodes = True
    node = made.node_tree.nodes["Principled BSDF"]
    node.distribution = "GGX"
    values = {"Base Color": (*color, 1), "Roughness": roughness, "Metallic": metallic,
              "Specular IOR Level": specular, **inputs}
    for key, value in values.items():
        node.inputs[key].default_value = value
    return made


def emission(name, color, strength):
    return material(name, (0, 0, 0),
                    **{"Emission Color": (*color, 1), "Emission Strength": strength})


def socket(made, name):
    return made.node_tree.nodes["Principled BSDF"].inputs[name]


def picture(name, texels, is_color=True):
    """An image from [row from below][column][channel] in 0 to 1, packed into the file."""
    height, width, _ = texels.shape
    image = bpy.data.images.new(name, width, height, alpha=True)
    image.colorspace_settings.name = "sRGB" if is_color else "Non-Color"
    full = numpy.ones((height, width, 4), numpy.float32)
    full[..., :texels.shape[2]] = texels
    image.pixels.foreach_set(full.ravel())
    image.update()
    image.pack()
    return image


def texture(made, image, scale=None):
    """A texture node of `made`; `scale`: of the coordinates, by a mapping node."""
    nodes, links = made.node_tree.nodes, made.node_tree.links
    node = nodes.new("ShaderNodeTexImage")
    node.image = image
    if scale is not None:
        mapping = nodes.new("ShaderNodeMapping")
        mapping.inputs["Scale"].default_value = scale
        coordinates = nodes.new("ShaderNodeUVMap")
        links.new(coordinates.outputs["UV"], mapping.inputs["Vector"])
        links.new(mapping.outputs["Vector"], node.inputs["Vector"])
    return node


def link(made, output, name):
    made.node_tree.links.new(output, socket(made, name))


def patches(size, seed, channels=3):
    """Smooth random colours, so that no filter matters; [size][size][channels]."""
    coarse = numpy.random.default_rng(seed).uniform(0.1, 0.9, (5, 5, channels))
    at = numpy.linspace(0, 3.999, size)
    whole, part = at.astype(int), (at % 1)[:, None]
    rows = coarse[whole] * (1 - part[..., None]) + coarse[whole + 1] * part[..., None]
    return rows[:, whole] * (1 - part[None]) + rows[:, whole + 1] * part[None]


def add(made, **where):
    added = bpy.context.object
    added.data.materials.append(made)
    for key, value in where.items():
        setattr(added, key, value)
    return added


def plane(made, size=10.0, **where):
    bpy.ops.mesh.primitive_plane_add(size=size)
    return add(made, **where)


def cube(made, size=1.0, **where):
    bpy.ops.mesh.primitive_cube_add(size=size)
    return add(made, **where)


def sphere(made, radius=0.7, **where):
    bpy.ops.mesh.primitive_uv_sphere_add(radius=radius, segments=64, ring_count=32)
    bpy.ops.object.shade_smooth()
    return add(made, **where)


def light(kind, energy, location=(0, 0, 3), rotation=(0, 0, 0), color=(1, 1, 1), **settings):
    data = bpy.data.lights.new(kind.lower(), kind)
    data.energy, data.color = energy, color
    if kind == "SUN":
        data.angle = 0
    else:
        data.shadow_soft_size = 0  # glTF's lights are points
    for key, value in settings.items():
        setattr(data, key, value)
    made = bpy.data.objects.new(kind.lower(), data)
    made.location, made.rotation_euler = location, rotation
    bpy.context.collection.objects.link(made)
    return made


def camera(name="camera", location=(4, -6, 4), look_at=(0, 0, 0.5), **settings):
    from mathutils import Vector

    data = bpy.data.cameras.new(name)
    for key, value in settings.items():
        setattr(data, key, value)
    made = bpy.data.objects.new(name, data)
    made.location = location
    made.rotation_euler = (Vector(look_at) - Vector(location)).to_track_quat("-Z", "Y").to_euler()
    bpy.context.collection.objects.link(made)
    bpy.context.scene.camera = made
    return made


def stage():
    """A floor, a wall, boxes and a ball, all diffuse."""
    plane(material("floor", (0.7, 0.7, 0.6)), 12)
    plane(material("wall", (0.6, 0.4, 0.3)), 12, location=(0, 3, 0),
          rotation_euler=(math.pi / 2, 0, 0))
    cube(material("box", (0.2, 0.5, 0.7)), location=(-1, 0.4, 0.5), rotation_euler=(0, 0, 0.5))
    cube(material("tall", (0.8, 0.8, 0.8)), location=(1.2, 1, 0.9), scale=(0.7, 0.7, 1.8))
    sphere(material("ball", (0.9, 0.5, 0.1)), location=(0.6, -1.2, 0.7))


def point_lights():
    stage()
    camera()
    light("POINT", 300, (-2, -2, 3), color=(1, 0.6, 0.3))
    light("POINT", 150, (3, -1, 1.5), color=(0.2, 0.5, 1))


def many_point_lights():
    stage()
    camera()
    for i, j in itertools.product(range(8), range(8)):
        light("POINT", 10, (i - 3.5, j - 5, 2 + 0.2 * ((i + j) % 3)), color=(1, i / 8, j / 8))


def spots():
    stage()
    camera()
    light("SPOT", 800, (-3, -3, 4), (0.6, 0.1, -0.7), spot_size=0.9, spot_blend=0)
    light("SPOT", 500, (2, -2, 5), (0.25, 0.3, 0), (0.3, 1, 0.4), spot_size=0.7, spot_blend=0)


def sun():
    stage()
    camera()
    light("SUN", 3, rotation=(0.7, 0.3, 0.4), color=(1, 0.9, 0.7))


def area_lights():
    """Emissive planes: Blender's exporter leaves area lamps out."""
    stage()
    camera()
    plane(emission("panel", (1, 0.9, 0.8), 20), 1, location=(-1, -2, 4.5),
          rotation_euler=(0.3, 0, 0))
    plane(emission("tube", (0.3, 0.6, 1), 30), 1, location=(3.5, 0, 1.2), scale=(0.05, 2, 1),
          rotation_euler=(0, -1.2, 0))


def lamps_and_emitters():
    """How bright lamps are beside emissive surfaces."""
    stage()
    camera()
    light("POINT", 200, (-2, -2, 3))
    plane(emission("panel", (0.2, 0.4, 1), 15), 1, location=(2, -2.5, 3.5),
          rotation_euler=(0.3, 0, 0))


def textures():
    stage()
    camera()
    floor = material("tiles")
    image = picture("tiles", patches(64, 1))
    link(floor, texture(floor, image, (2, 3, 1)).outputs["Color"], "Base Color")
    plane(floor, 8, location=(0, -0.5, 0.01), rotation_euler=(0, 0, 0.3))
    poster = material("poster")
    link(poster, texture(poster, picture("poster", patches(64, 2))).outputs["Color"], "Base Color")
    plane(poster, 2, location=(-2, 2.9, 2), rotation_euler=(math.pi / 2, 0, 0))
    light("POINT", 400, (-1, -3, 4))
    light("SUN", 1, rotation=(0.5, -0.4, 0))


def normal_map():
    camera()
    waves = numpy.sin(numpy.linspace(0, 4 * math.pi, 256))
    image = numpy.stack(numpy.meshgrid(*[waves] * 2), -1) * 0.3
    z = numpy.sqrt(1 - (image**2).sum(-1, keepdims=True))
    made = material("waves")
    node = made.node_tree.nodes.new("ShaderNodeNormalMap")
    color = texture(made, picture("waves", numpy.concatenate([image, z], -1) / 2 + 0.5, False))
    made.node_tree.links.new(color.outputs["Color"], node.inputs["Color"])
    link(made, node.outputs["Normal"], "Normal")
    plane(made, 8)
    light("POINT", 400, (-1, -2, 4))
    light("SUN", 1, rotation=(0.5, -0.4, 0))


def vertex_colors():
    camera()
    floor = material("painted")
    node = floor.node_tree.nodes.new("ShaderNodeVertexColor")
    node.layer_name = "Color"
    link(floor, node.outputs["Color"], "Base Color")
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=12, y_subdivisions=12, size=8)
    mesh = add(floor).data
    colors = mesh.color_attributes.new("Color", "FLOAT_COLOR", "POINT")
    for i, vertex in enumerate(mesh.vertices):
        x, y = vertex.co.x / 8 + 0.5, vertex.co.y / 8 + 0.5
        colors.data[i].color = (x, y, 0.5 + 0.5 * math.sin(6 * x), 1)
    light("POINT", 400, (1, -1, 4))


def leaf(size=128):
    """Alpha of a leaf of blurred edge; [size][size]."""
    x, y = numpy.meshgrid(*[numpy.linspace(-1, 1, size)] * 2)
    wave = 0.2 * numpy.sin(7 * numpy.arctan2(y, x))
    return numpy.clip(4 * (0.8 - numpy.hypot(x, y) - wave), 0, 1)


def leaves(made):
    stage()
    camera()
    for i, (x, y) in enumerate(itertools.product((-2, 0, 2), (-2, 0.5))):
        plane(made, 1.6, location=(x, y, 2 + 0.1 * i), rotation_euler=(0.3 * i, 0.4 * i, i))
    light("POINT", 500, (-1, -2, 5))
    light("SUN", 1, rotation=(0.3, 0.3, 0))


def textured(name, alpha):
    made = material(name)
    image = picture(name, numpy.concatenate([patches(128, 3), alpha[..., None]], -1))
    image.alpha_mode = "CHANNEL_PACKED"
    node = texture(made, image)
    link(made, node.outputs["Color"], "Base Color")
    return made, node


def alpha_mask():
    made, node = textured("leaf", leaf())
    clip = made.node_tree.nodes.new("ShaderNodeMath")
    clip.operation = "ROUND"
    made.node_tree.links.new(node.outputs["Alpha"], clip.inputs[0])
    link(made, clip.outputs[0], "Alpha")
    leaves(made)


def alpha_blend():
    made, node = textured("veil", leaf() * 0.7)
    link(made, node.outputs["Alpha"], "Alpha")
    leaves(made)


def screen():
    """An emissive texture, seen and lighting."""
    stage()
    camera()
    made = material("screen", (0, 0, 0), **{"Emission Strength": 8.0})
    texels = numpy.full((64, 64, 3), 0.02)
    texels[8:24, 8:40], texels[40:60, 30:60] = (1, 0.3, 0.1), (0.2, 0.9, 1)
    node = texture(made, picture("screen", texels))
    node.interpolation = "Closest"
    link(made, node.outputs["Color"], "Emission Color")
    plane(made, 2, location=(-1, 2.5, 2), rotation_euler=(math.pi / 2, 0, 0))


def instances():
    """Objects that share a mesh, one turned inside out, below a moved parent."""
    stage()
    camera()
    first = cube(material("peg", (0.9, 0.3, 0.3)), 0.3, location=(-2.5, -2, 0.2))
    parent = bpy.data.objects.new("group", None)
    parent.location, parent.rotation_euler, parent.scale = (0.3, 0, 0.2), (0, 0, 0.4), (1.2, 0.8, 1)
    bpy.context.collection.objects.link(parent)
    for i, j in itertools.product(range(6), range(4)):
        copy = first.copy()
        copy.location, copy.rotation_euler = (i - 2.5, j - 3, 0.2), (0, 0.1 * j, 0.3 * i)
        copy.scale = (-1 if (i + j) % 2 else 1, 1, 1 + 0.3 * j)
        copy.parent = parent
        bpy.context.collection.objects.link(copy)
    light("POINT", 400, (-2, -2, 4))


def posed():
    """A shape key half way."""
    stage()
    camera()
    made = sphere(material("soft", (0.6, 0.8, 0.4)), 0.6, location=(-1, -2, 0.7))
    made.shape_key_add(name="Basis")
    key = made.shape_key_add(name="long")
    for point in key.data:
        point.co.z *= 1.8
    key.value = 0.5
    light("POINT", 400, (-2, -3, 4))


def shapes(roughness, metallic):
    plane(material("floor", (0.5, 0.5, 0.5), roughness, metallic, 0.5), 12)
    sphere(material("ball", (0.9, 0.6, 0.3), roughness, metallic, 0.5), 1, location=(-1, 0, 1))
    cube(material("box", (0.3, 0.5, 0.9), roughness, metallic, 0.5), 1.4, location=(1.4, 0, 0.7))
    camera()


def rough_metal():
    shapes(0.4, 1.0)
    light("POINT", 400, (-3, 0, 4))
    light("SUN", 2, rotation=(-0.7, 0.3, 0))


def plastic():
    shapes(0.4, 0.0)
    light("POINT", 400, (-3, 0, 4))
    light("SUN", 2, rotation=(-0.7, 0.3, 0))


def glossy_area():
    shapes(0.25, 1.0)
    plane(emission("panel", (1, 0.9, 0.8), 10), 2, location=(-1, 3, 3), rotation_euler=(1, 0, 0))


def roughness_map():
    shapes(0.5, 0.0)
    made = material("worn", (0.8, 0.7, 0.5), specular=0.5)
    texels = patches(64, 5)
    node = texture(made, picture("worn", texels, False))
    split = made.node_tree.nodes.new("ShaderNodeSeparateColor")
    made.node_tree.links.new(node.outputs["Color"], split.inputs["Color"])
    link(made, split.outputs["Green"], "Roughness")
    link(made, split.outputs["Blue"], "Metallic")
    plane(made, 6, location=(0, 0, 0.01))
    light("POINT", 600, (-3, 1, 4))
    light("SUN", 2, rotation=(-0.7, 0.3, 0))


def portrait():
    stage()
    camera(lens=30)
    light("POINT", 300, (-2, -2, 3))


def orthographic():
    stage()
    camera(type="ORTHO", ortho_scale=7)
    light("POINT", 300, (-2, -2, 3))
