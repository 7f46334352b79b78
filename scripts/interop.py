# SPDX-License-Identifier: MIT
"""The comparison of interop.sh, which installs Blender as a Python module and builds the program.

Every scene of interop_scenes.py is made in Blender with Blender's own lights, materials, textures
and cameras, exported by Blender's glTF exporter and rendered twice: by Cycles, direct light only,
and by manylight from the exported file. Of both images the ratio of means and the mean difference
of blocks of 8 x 8 pixels relative to the mean are printed; a light, texture or camera that is
turned or moved shows in the latter.
"""
import argparse
import contextlib
import os
import pathlib
import subprocess
import sys

import bpy
import numpy

import interop_scenes as scenes

FOLDER = pathlib.Path("build/interop")
PROGRAM = "build/manylight"
LUMENS_PER_WATT = 683  # of Blender's "Standard" lighting mode
BLOCK = 8

# scene, largest difference of the means
DIFFUSE, GLOSSY = 0.01, 0.03
SCENES = (
    (scenes.point_lights, DIFFUSE), (scenes.many_point_lights, DIFFUSE), (scenes.spots, DIFFUSE),
    (scenes.sun, DIFFUSE), (scenes.area_lights, DIFFUSE), (scenes.lamps_and_emitters, DIFFUSE),
    (scenes.textures, DIFFUSE), (scenes.normal_map, DIFFUSE), (scenes.vertex_colors, DIFFUSE),
    (scenes.alpha_mask, DIFFUSE), (scenes.alpha_blend, DIFFUSE), (scenes.screen, DIFFUSE),
    (scenes.instances, DIFFUSE), (scenes.posed, DIFFUSE), (scenes.portrait, DIFFUSE),
    (scenes.orthographic, DIFFUSE), (scenes.rough_metal, GLOSSY), (scenes.plastic, GLOSSY),
    (scenes.glossy_area, GLOSSY), (scenes.roughness_map, GLOSSY))
SIZES = {"portrait": (240, 360)}
BLOCKS = 3  # the blocks' differences may be so many times larger than the means'


# Both renderers


@contextlib.contextmanager
def quiet():
    """Blender and its exporter print on the file descriptors themselves."""
    sys.stdout.flush()
    kept, nothing = [os.dup(1), os.dup(2)], os.open(os.devnull, os.O_WRONLY)
    os.dup2(nothing, 1)
    os.dup2(nothing, 2)
    try:
        yield
    finally:
        for number, old in enumerate(kept, 1):
            os.dup2(old, number)
            os.close(old)
        os.close(nothing)


def empty_scene(width, height, samples):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.render.resolution_x, scene.render.resolution_y = width, height
    scene.render.image_settings.file_format = "OPEN_EXR"
    scene.render.image_settings.color_depth = "32"
    cycles = scene.cycles
    cycles.device, cycles.samples, cycles.seed = "CPU", samples, 1
    cycles.use_adaptive_sampling = cycles.use_denoising = False
    cycles.pixel_filter_type = "BOX"
    cycles.max_bounces = 0  # direct light only
    cycles.transparent_max_bounces = 64
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0
    cycles.blur_glossy = 0
    cycles.light_sampling_threshold = 0
    scene.world = bpy.data.worlds.new("black")
    scene.world.color = (0, 0, 0)
    return scene


def load(file):
    """[row from below][column][RGB], linear."""
    image = bpy.data.images.load(str(file.resolve()))
    image.colorspace_settings.name = "Non-Color"
    width, height = image.size
    values = numpy.empty(width * height * 4, numpy.float32)
    image.pixels.foreach_get(values)
    return values.reshape(height, width, 4)[..., :3].astype(float)


def blocks(image):
    rows, columns = image.shape[0] // BLOCK, image.shape[1] // BLOCK
    cut = image[:rows * BLOCK, :columns * BLOCK]
    return cut.reshape(rows, BLOCK, columns, BLOCK, 3).mean((1, 3))


def render_both(make, samples, lighting="COMPAT", more=(), **export):
    """Returns Cycles' image and manylight's."""
    name = make.__name__
    width, height = SIZES.get(name, (320, 240))
    scene = empty_scene(width, height, samples)
    make()
    glb, exr = FOLDER / f"{name}.glb", FOLDER / f"{name}.exr"
    cycles = FOLDER / f"{name}-cycles.exr"
    scene.render.filepath = str(cycles.resolve())
    with quiet():
        bpy.ops.export_scene.gltf(filepath=str(glb.resolve()), export_lights=True,
                                  export_cameras=True,
                                  export_import_convert_lighting_mode=lighting, **export)
        bpy.ops.render.render(write_still=True)
    subprocess.run([PROGRAM, "render", glb, "--quiet", "--width", str(width), "--height",
                    str(height),
                    "--spp", str(samples), "--light-samples", "16", "-o", exr, *more], check=True)
    return load(cycles), load(exr)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--only", help="names of scenes, separated by commas")
    parser.add_argument("--samples", type=int, default=128, help="pixel samples of both")
    options = parser.parse_args()
    only = options.only.split(",") if options.only else None
    FOLDER.mkdir(parents=True, exist_ok=True)
    cases = [(make.__name__, make, most, {}) for make, most in SCENES]
    cases += [
        ("instances as EXT_mesh_gpu_instancing", scenes.instances, DIFFUSE,
         {"export_gpu_instances": True}),
        ("textures, Draco", scenes.textures, DIFFUSE,
         {"export_draco_mesh_compression_enable": True}),
        ("lamps_and_emitters, Standard", scenes.lamps_and_emitters, DIFFUSE,
         {"lighting": "SPEC", "more": ("--lamp-scale", str(1 / LUMENS_PER_WATT))})]
    failed = 0
    print(f"Blender {bpy.app.version_string}, {options.samples} pixel samples\n")
    print(f"{'scene':40} {'manylight / Cycles':>18} {'8 x 8 blocks':>13}")
    for name, make, most, settings in cases:
        if only and make.__name__ not in only:
            continue
        theirs, ours = render_both(make, options.samples, **settings)
        mean = theirs.mean()
        ratio = ours.mean() / mean
        differ = numpy.abs(blocks(ours) - blocks(theirs)).mean() / mean
        good = abs(ratio - 1) <= most and differ <= BLOCKS * most
        failed += not good
        print(f"{name:40} {ratio:18.4f} {100 * differ:12.2f}%{'' if good else '  MISSED'}",
              flush=True)
    if failed:
        print(f"{failed} scenes differ by more than {100 * DIFFUSE:.0f}% (diffuse) or "
              f"{100 * GLOSSY:.0f}% (glossy), or their blocks by {BLOCKS} times as much")
    return 1 if failed else 0


if __name__ == "__main__":
    status = main()
    sys.stdout.flush()
    os._exit(status)  # Blender may crash when Python takes it down
