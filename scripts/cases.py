# SPDX-License-Identifier: MIT
"""Renders the cases of a folder and compares each with its expected value; see cases.sh."""
import argparse
import json
import math
import pathlib
import re
import subprocess
import sys
import tempfile

import numpy
import OpenImageIO

arguments = argparse.ArgumentParser(description=__doc__)
arguments.add_argument("program", type=pathlib.Path)
arguments.add_argument("folder", type=pathlib.Path)
arguments.add_argument("--only", default="", help="cases whose names contain this")
options = arguments.parse_args()
scratch = pathlib.Path(tempfile.mkdtemp())
EXACT = ("--sampler", "exhaustive", "--pixel-centre", "--spp", "1")
cases = []


class Failure(Exception):
    """What was found instead of what was expected."""


def case(function):
    cases.append(function)
    return function


def expect(condition, found):
    if not condition:
        raise Failure(found)


def manylight(*words):
    return subprocess.run([options.program.resolve(), *map(str, words)], capture_output=True,
                          text=True, timeout=900)


def render(name, *words):
    """The image [row][column][channel], cd/m2, and what the program said."""
    image = scratch / "image.exr"
    image.unlink(missing_ok=True)
    path = name if isinstance(name, pathlib.Path) else options.folder / name
    done = manylight("render", path, "-o", image, *words)
    expect(done.returncode == 0, f"{path.name} is refused: {done.stderr.strip()[:200]}")
    # An ImageBuf would be the cached one of a render in the same second.
    pixels = OpenImageIO.ImageInput.open(str(image)).read_image()
    return pixels[..., :3], done.stdout + done.stderr


def refusal(name, *parts):
    done = manylight("render", options.folder / name, "-o", scratch / "image.exr")
    expect(done.returncode == 2 and all(part in done.stderr for part in parts),
           f"exit code {done.returncode}: {done.stderr.strip()[:200]}")


def difference(image, truth):
    """relMSE, as docs/stopping.md has it, but for the share of pixels that matter least."""
    return numpy.mean((image - truth) ** 2 / (truth ** 2 + 1e-2 * numpy.mean(truth) ** 2))


def differing(image, truth, share=0.05):
    """The share of pixels that are off by more than a share of the image's largest value."""
    return numpy.mean(numpy.abs(image - truth).max(axis=2) > share * truth.max())


def same_as(name, truth, most_pixels, words=EXACT, size=(160, 120)):
    words = (*words, "--width", size[0], "--height", size[1])
    image, _ = render(name, *words)
    expected, _ = render(truth, *words)
    found = differing(image, expected)
    expect(found <= most_pixels, f"{100 * found:.2f}% of the pixels differ")
    return f"{100 * found:.2f}% of the pixels differ"


@case
def unlit_only():
    image, _ = render("unlit-only.gltf", "--width", 64, "--height", 48)
    found = image.max(axis=(0, 1))
    expect(numpy.allclose(found, (0.5, 0.3, 0.8), rtol=1e-5), f"{found}")


@case
def no_light():
    _, words = render("no-light.gltf", "--width", 16, "--stats", scratch / "stats.json")
    expect("nan" not in words, words)
    expect("null" not in (scratch / "stats.json").read_text().split('"spp"')[1][:12], "spp is null")


@case
def large_ground():
    return same_as("large-ground.gltf", "large-ground-truth.gltf", 0.0001)


@case
def shade_2km():
    return same_as("shade-2km.gltf", "shade-truth.gltf", 0.01)


def moved_room(name):
    words = (*EXACT, "--width", 160, "--height", 120)
    found = difference(render(name, *words)[0], render("room-truth.gltf", *words)[0])
    expect(found <= 1e-6, f"relMSE {found:.3g}")
    return f"relMSE {found:.2g}"


@case
def room_100km():
    return moved_room("room-100km.gltf")


@case
def room_1000km():
    return moved_room("room-1000km.gltf")


def beam(name):
    """A disc of 1 cd/m2 on the plane z = 0, under an orthographic camera that looks along -z."""
    scene = json.loads((options.folder / name).read_text())
    view = scene["cameras"][0]["orthographic"]
    spot = scene["extensions"]["KHR_lights_punctual"]["lights"][0]["spot"]
    radius = 10 * math.tan(spot["outerConeAngle"])
    image, _ = render(name, "--width", 640, "--height", 480, *EXACT)
    found = image[..., 0].mean() * 4 * view["xmag"] * view["ymag"] / (math.pi * radius ** 2)
    expect(abs(found - 1) < 0.01, f"{found:.4f} of the right mean")
    return f"{found:.4f} of the right mean"


@case
def beam_sharp_quarter_degree():
    return beam("beam-sharp-0.25deg.gltf")


@case
def beam_sharp_1_degree():
    return beam("beam-sharp-1deg.gltf")


@case
def chip_300um():
    image, _ = render("chip-300um.gltf", "--width", 160, "--height", 120)
    columns = int((image.max(axis=(0, 2)) > 0).sum())
    expect(columns >= 96, f"{columns} columns of 160")
    return f"{columns} columns of 160"


@case
def znear():
    image, _ = render("znear.gltf", "--width", 96, "--height", 72)
    expect(image.mean() > 0.01 and image[..., 2].mean() > 0, f"mean {image.mean(axis=(0, 1))}")


@case
def masked_emitter():
    words = ("--sampler", "exhaustive", "--spp", 64, "--hide-emitters", "--width", 96)
    found = render("masked-emitter.gltf", *words)[0].mean() / render(
        "masked-emitter-truth.gltf", *words)[0].mean()
    expect(abs(found - 1) < 0.02, f"{found:.3f} times the light")
    return f"{found:.3f} times the light"


@case
def hidden_by_scale_0():
    render("hidden-by-scale-0.gltf", "--at", 1, "--width", 16)


@case
def negative_xmag():
    text = (options.folder / "negative-xmag.gltf").read_text()
    upright = scratch / "upright.gltf"
    upright.write_text(re.sub(r'"xmag":\s*-', '"xmag": ', text))
    words = (*EXACT, "--width", 64, "--height", 64)
    image, _ = render("negative-xmag.gltf", *words)
    expected, _ = render(upright, *words)
    expect(differing(image, expected[:, ::-1]) <= 0.01, "not the mirrored image")


@case
def nanometre_emitter():
    words = ("--sampler", "exhaustive", "--spp", 64, "--width", 96)
    found = render("nanometre-emitter.gltf", *words)[0].mean() / render(
        "nanometre-emitter-truth.gltf", *words)[0].mean()
    expect(abs(found - 1) < 0.01, f"{found:.4f} times the light")
    return f"{found:.4f} times the light"


@case
def closed_room():
    words = ("--width", 96, "--height", 72, "--pixel-centre")
    found = difference(render("closed-room.glb", *words, "--spp", 4)[0],
                       render("closed-room.glb", *words, "--sampler", "exhaustive")[0])
    expect(found < 1, f"relMSE {found:.3g}")
    return f"relMSE {found:.3g}"


@case
def terminator():
    """The image of a sphere of few triangles beside that of a sphere, shaded alike."""
    scene = json.loads((options.folder / "terminator.gltf").read_text())
    width, height = 320, 240
    image, _ = render("terminator.gltf", "--width", width, "--height", height, *EXACT)
    nodes = {key: node for node in scene["nodes"] for key in node}
    view = numpy.array(nodes["camera"]["matrix"]).reshape(4, 4).T
    lens = scene["cameras"][0]["perspective"]
    up = math.tan(lens["yfov"] / 2)
    x, y = numpy.meshgrid((numpy.arange(width) + 0.5) / width * 2 - 1,
                          1 - (numpy.arange(height) + 0.5) / height * 2)
    rays = numpy.stack([x * up * lens["aspectRatio"], y * up, -numpy.ones_like(x)], -1)
    rays = rays @ view[:3, :3].T
    rays /= numpy.linalg.norm(rays, axis=-1, keepdims=True)
    origin = view[:3, 3]
    along = rays @ origin
    inside = along ** 2 - (origin @ origin - 1)
    hit = inside > 0.05  # well off the outline
    normal = origin + rays * (-along - numpy.sqrt(numpy.maximum(inside, 0)))[..., None]
    qx, qy, qz, qw = next(n["rotation"] for n in scene["nodes"] if "rotation" in n)
    to_light = numpy.array([2 * (qx * qz + qw * qy), 2 * (qy * qz - qw * qx),
                            1 - 2 * (qx * qx + qy * qy)])
    cosine = normal @ to_light
    lit = image.max(axis=2) > 0
    wrong = hit & (lit != (cosine > 0)) & (numpy.abs(cosine) > 0.05)
    found = wrong.sum() / (hit & (numpy.abs(cosine) < 0.3)).sum()
    expect(found < 0.01, f"{100 * found:.1f}% of the pixels near the light's edge are wrong")
    return f"{100 * found:.2f}% of the pixels near the light's edge are wrong"


def verify(name):
    done = manylight("verify", options.folder / name, "--width", 48)
    expect(done.returncode == 0, (done.stdout + done.stderr)[-300:])


@case
def verify_slivers():
    verify("slivers.glb")


@case
def verify_beam():
    verify("beam-sharp-0.25deg.gltf")


@case
def verify_ground_of_100km():
    verify("verify-100km-ground.gltf")


@case
def uri_outside():
    render("uri/scene/plain.gltf", "--width", 16)
    refusal("uri/scene/nulzz.gltf", "nulzz.gltf")


@case
def names_with_escapes():
    for name in ("esc.glb", "ext.gltf", "warn.gltf"):
        done = manylight("render", options.folder / name, "-o", scratch / "image.exr", "--width",
                         16)
        words = done.stdout + done.stderr
        expect(not re.search(r"[\x00-\x08\x0b-\x1f\x7f]", words.replace("\r", "")), repr(words))


@case
def stopped_by_its_own_error():
    """One lamp behind a film with an alpha of 0.97: alone they give 0.1884 and 6.835 cd/m2."""
    expected = 0.1884 + 0.03 * 6.835
    means = [render("stop.glb", "--width", 4, "--height", 4, "--sampler", "exhaustive",
                    "--target-error", 0.02, "--seed", seed)[0].mean() for seed in range(40)]
    mean, error = numpy.mean(means), numpy.std(means) / math.sqrt(len(means))
    expect(abs(mean - expected) < 3 * error, f"mean {mean:.3f} +- {error:.3f}, not {expected:.3f}")
    return f"mean {mean:.3f} +- {error:.3f}"


def shows(name, parts, black):
    """Renders, says these words, and is not black but for the reason that is said."""
    image, words = render(f"files/{name}", "--width", 48, "--height", 36)
    expect(all(part in words for part in parts), words[:300])
    expect(image.max() > 0 if black is None else black in words, "black")


def add_file(name, *parts, black=None):
    def function():
        shows(name, parts, black)
    function.__name__ = name
    cases.append(function)


add_file("non_root_scene_node_kenney_lemon.gltf", "is no root")
add_file("00_no_scenes.gltf")
add_file("no_scene_transform_matrices.gltf", black="has no triangles")
add_file("meshopt-no-fallback.gltf")
add_file("quaternion_norm_0.95.gltf", "rotation is no unit quaternion")
add_file("glb_chunk_length_not_multiple_of_4.glb", "multiple of 4")
add_file("emissiveFactor_above_1_space.gltf", "is above 1")
add_file("texcoord_missing_issue_3269.gltf", "lacks TEXCOORD_0")
add_file("texture_without_image_nvidia_cornellBox.gltf", "is no image")
add_file("subpass_scene_opaque.gltf", "not finite")
add_file("required_transmission.gltf", "KHR_materials_transmission")
add_file("required_variants.gltf")
add_file("required_spec_gloss_emission_strength.gltf")
add_file("unlit_without_lights_is_black.glb")


@case
def node_with_two_parents():
    refusal("files/node_with_two_parents_cube_att.gltf", "is already a child")


@case
def vertices_at_infinity():
    refusal("files/BoxWithInfinites.glb", "is not finite")


failed = 0
for function in cases:
    name = function.__name__
    if options.only not in name:
        continue
    try:
        print(f"right  {name}: {function() or ''}", flush=True)
    except Failure as failure:
        failed += 1
        print(f"WRONG  {name}: {failure}", flush=True)
sys.exit(1 if failed else 0)
