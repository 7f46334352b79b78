# SPDX-License-Identifier: MIT
"""Makes malformed glTF files and expects each to be refused with one clear message.

usage: malformed.py MANYLIGHT [FOLDER]    FOLDER keeps the files

Each case changes one thing in a valid file and names words that the message must hold: the object
and the value. A refusal is one line on standard error, "error: FILE: ...", and exit code 1 to 3, in
time; run with a program built under sanitizers, whose reports fail the case.
"""
import base64
import concurrent.futures
import json
import os
import pathlib
import struct
import subprocess
import sys
import tempfile
import zlib

POSITIONS = struct.pack("<12f", 0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0)
INDICES = struct.pack("<6H", 0, 1, 2, 2, 1, 3)
DATA = POSITIONS + INDICES


def png(width, height, rows):
    """A PNG file of that header, RGB, whatever its rows hold."""
    def chunk(kind, data):
        return (struct.pack(">I", len(data)) + kind + data
                + struct.pack(">I", zlib.crc32(kind + data)))
    return (b"\x89PNG\r\n\x1a\n"
            + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0))
            + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b""))


TEXTURE = png(2, 2, b"\0\xff\0\0\0\xff\0" * 2)
# Images beside the scene.
IMAGES = {
    "texture.png": TEXTURE,
    "cut off.png": TEXTURE[:45],
    "empty.png": b"",
    "text.png": b"This is no image.",
    "exif.webp": base64.b64decode(
        "UklGRnYAAABXRUJQVlA4WAoAAAAIAAAAAQAAAQAAVlA4IBoAAAAwAQCdASoCAAIAAAAAJaQAA3AA/v/fbtQAAEVYSU"
        "YEAAAASUlJSVhYSUkqAAAA/38AAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAA"),
    "rows missing.png": png(900, 900, b"\0\xff\0\0"),
    "wide.png": png(60000, 2, b"\0\xff\0\0"),
    "huge.png": png(16000, 16000, bytes(1000000)),
}


def valid():
    return {
        "asset": {"version": "2.0"},
        "extensionsUsed": ["KHR_lights_punctual"],
        "extensions": {"KHR_lights_punctual": {"lights": [
            {"type": "point", "color": [1, 1, 1], "intensity": 5, "range": 10},
            {"type": "spot", "spot": {"innerConeAngle": 0.1, "outerConeAngle": 0.5}},
        ]}},
        "scene": 0,
        "scenes": [{"nodes": [0, 1, 2]}],
        "nodes": [
            {"mesh": 0, "children": [3]},
            {"translation": [0, 0, 3], "extensions": {"KHR_lights_punctual": {"light": 0}}},
            {"camera": 0, "translation": [0, 0, 4]},
            {"rotation": [0, 0, 0, 1], "scale": [1, 1, 1]},
        ],
        "cameras": [
            {"type": "perspective", "perspective": {"yfov": 1, "aspectRatio": 1, "znear": 0.1}},
            {"type": "orthographic",
             "orthographic": {"xmag": 1, "ymag": 1, "znear": 0, "zfar": 9}},
        ],
        "materials": [{
            "pbrMetallicRoughness": {"baseColorFactor": [1, 1, 1, 1], "metallicFactor": 0,
                                     "roughnessFactor": 1, "baseColorTexture": {"index": 0}},
            "emissiveFactor": [0, 0, 0], "doubleSided": True, "alphaMode": "OPAQUE",
            "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": 1},
                           "KHR_materials_specular": {"specularFactor": 0}},
        }],
        "textures": [{"source": 0, "sampler": 0}],
        "samplers": [{}],
        "images": [{"uri": "texture.png"}],
        "skins": [{"joints": [3]}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "NORMAL": 0, "TEXCOORD_0": 2},
                                    "indices": 1,
                                    "material": 0, "mode": 4}]}],
        "accessors": [
            {"bufferView": 0, "byteOffset": 0, "componentType": 5126, "count": 4, "type": "VEC3",
             "min": [0, 0, 0], "max": [1, 1, 0]},
            {"bufferView": 1, "componentType": 5123, "count": 6, "type": "SCALAR"},
            {"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC2"},
        ],
        "bufferViews": [{"buffer": 0, "byteOffset": 0, "byteLength": 48, "byteStride": 12},
                        {"buffer": 0, "byteOffset": 48, "byteLength": 12}],
        "buffers": [{"byteLength": 60,
                     "uri": "data:application/octet-stream;base64,"
                            + base64.b64encode(DATA).decode()}],
    }


def glb(document=None, chunks=None, version=2, length=None, binary=DATA):
    if chunks is None:
        document = document or valid()
        document["buffers"] = [{"byteLength": len(binary)}]
        text = json.dumps(document).encode()
        text += b" " * (-len(text) % 4)
        chunks = [(0x4E4F534A, text), (0x004E4942, binary + b"\0" * (-len(binary) % 4))]
    body = b"".join(struct.pack("<II", len(data), kind) + data for kind, data in chunks)
    total = 12 + len(body) if length is None else length
    return b"glTF" + struct.pack("<II", version, total) + body


def put(path, value):
    """A change that puts a value at a path of keys; `...` as a value deletes."""
    def change(document):
        place = document
        for key in path[:-1]:
            place = place[key]
        if value is ...:
            del place[path[-1]]
        else:
            place[path[-1]] = value
    return change


def patched(offset, data):
    """The valid file with other bytes in its buffer."""
    changed = DATA[:offset] + data + DATA[offset + len(data):]
    return put(["buffers", 0, "uri"],
               "data:application/octet-stream;base64," + base64.b64encode(changed).decode())


def sparse(count=1, componentType=5123, offset=0, stride=...):
    """Sparse positions: numbers from the indices' bytes, values from the positions'."""
    def change(document):
        document["bufferViews"].append({"buffer": 0, "byteOffset": 48, "byteLength": 4})
        document["bufferViews"].append({"buffer": 0, "byteLength": 12})
        document["accessors"][0]["sparse"] = {
            "count": count,
            "indices": {"bufferView": 1 if offset == 4 else 2, "byteOffset": offset,
                        "componentType": componentType},
            "values": {"bufferView": 0 if stride != ... else 3}}
    return change


def compressed(whole=48, **changes):
    """Positions compressed by meshopt: bytes that hold none."""
    def change(document):
        document["buffers"].append({"byteLength": whole, "extensions": {
            "EXT_meshopt_compression": {"fallback": True}}})
        document["bufferViews"][0] = {"buffer": 1, "byteLength": whole, "extensions": {
            "EXT_meshopt_compression": dict({
                "buffer": 0, "byteLength": 48, "byteStride": 12, "count": 4,
                "mode": "ATTRIBUTES"}, **changes)}}
    return change


def draco(data=b"", mode=4, view=None):
    """The first primitive as one of Draco data."""
    def change(document):
        data_uri = "data:application/octet-stream;base64," + base64.b64encode(data or DATA).decode()
        document["buffers"].append({"byteLength": len(data or DATA), "uri": data_uri})
        document["bufferViews"].append({"buffer": len(document["buffers"]) - 1,
                                        "byteLength": len(data or DATA)})
        document["meshes"][0]["primitives"][0].update(mode=mode, extensions={
            "KHR_draco_mesh_compression": {
                "bufferView": len(document["bufferViews"]) - 1 if view is None else view,
                "attributes": {"POSITION": 0}}})
    return change


POSITION, INDEX = ["accessors", 0], ["accessors", 1]
VIEW, BUFFER = ["bufferViews", 0], ["buffers", 0]
MATERIAL, PBR = ["materials", 0], ["materials", 0, "pbrMetallicRoughness"]
PRIMITIVE = ["meshes", 0, "primitives", 0]
LIGHT = ["extensions", "KHR_lights_punctual", "lights", 0]
SPOT = ["extensions", "KHR_lights_punctual", "lights", 1, "spot"]
LENS = ["cameras", 0, "perspective"]
ORTHO = ["cameras", 1, "orthographic"]
NAN = struct.pack("<f", float("nan"))
INF = struct.pack("<f", float("inf"))
INFINITIES = "data:application/octet-stream;base64," + base64.b64encode(8 * INF).decode()


def many_instances(nodes, count, attribute):
    """Of 1000 primitives, `count` for each node; places or scales are zeros, of no file."""
    def change(document):
        document["accessors"].append({"componentType": 5126, "type": "VEC3", "count": count})
        document["meshes"][document["nodes"][0]["mesh"]]["primitives"] *= 1000
        document["nodes"][0]["extensions"] = {"EXT_mesh_gpu_instancing": {
            "attributes": {attribute: len(document["accessors"]) - 1}}}
        for _ in range(nodes - 1):
            document["scenes"][0]["nodes"].append(len(document["nodes"]))
            document["nodes"].append({key: document["nodes"][0][key]
                                      for key in ("mesh", "extensions")})
    return change


# name: (change, words that the message must hold)
CHANGES = {
    "asset missing": (put(["asset"], ...), ["'asset' is missing"]),
    "asset no object": (put(["asset"], 3), ["asset", "3", "not an object"]),
    "version missing": (put(["asset", "version"], ...), ["asset", "'version'"]),
    "version 1": (put(["asset", "version"], "1.0"), ["asset.version", "1.0", "gltf-pipeline -i"]),
    "version 1 as a number":
        (put(["asset", "version"], 1), ["asset.version", "1", "gltf-pipeline -i"]),
    "version 3": (put(["asset", "version"], "3.0"), ["asset.version", "3.0"]),
    "version a number": (put(["asset", "version"], 2), ["asset.version", "not a string"]),
    "minimum version": (put(["asset", "minVersion"], "2.9"), ["asset.minVersion", "2.9"]),
    "unknown required extension": (put(["extensionsRequired"], ["VENDOR_voxels"]),
                                   ["extensionsRequired[0]", "VENDOR_voxels"]),
    "required KTX2": (put(["extensionsRequired"], ["KHR_texture_basisu"]),
                      ["extensionsRequired[0]", "KTX2", "gltf-transform ktxdecompress"]),
    "required extension no string": (put(["extensionsRequired"], [7]), ["extensionsRequired[0]"]),
    "extensions used no array": (put(["extensionsUsed"], {}), ["extensionsUsed", "not an array"]),
    "nodes no array": (put(["nodes"], {"0": {}}), ["nodes", "not an array"]),
    "node no object": (put(["nodes", 0], "mesh"), ["nodes[0]", "not an object"]),
    "scene beyond": (put(["scene"], 1), ["scene", "no scene 1"]),
    "scene negative": (put(["scene"], -1), ["scene", "-1"]),
    "scene a fraction": (put(["scene"], 0.5), ["scene", "0.5"]),
    "scene node beyond": (put(["scenes", 0, "nodes"], [9]), ["scenes[0].nodes[0]", "9"]),
    "no scene": (put(["scenes"], ...), ["scene"]),
    "emitter points": (put(["scenes", 0, "extras"], {"emitter_points": -4}),
                       ["emitter_points", "-4"]),
    "emitter points huge": (put(["scenes", 0, "extras"], {"emitter_points": 10**12}),
                            ["emitter_points", str(10**12)]),
    "node mesh beyond": (put(["nodes", 0, "mesh"], 5), ["nodes[0].mesh", "5"]),
    "node mesh a string": (put(["nodes", 0, "mesh"], "0"), ["nodes[0].mesh", "\"0\""]),
    "node camera beyond": (put(["nodes", 2, "camera"], 2), ["nodes[2].camera", "2"]),
    "node skin beyond": (put(["nodes", 0, "skin"], 1), ["nodes[0].skin", "1"]),
    "node child beyond": (put(["nodes", 0, "children"], [4]), ["nodes[0].children[0]", "4"]),
    "node its own child": (put(["nodes", 3, "children"], [3]), ["node 3"]),
    "node cycle": (lambda d: (d["nodes"].extend([{"children": [5]}, {"children": [4]}])),
                   ["its own ancestor"]),
    "node with two parents": (put(["nodes", 1, "children"], [3]), ["node 3", "already"]),
    "rotation of three": (put(["nodes", 3, "rotation"], [0, 0, 1]), ["nodes[3].rotation", "3"]),
    "rotation of zeros": (put(["nodes", 3, "rotation"], [0, 0, 0, 0]), ["nodes[3].rotation"]),
    "rotation no unit": (put(["nodes", 3, "rotation"], [1, 1, 1, 1]),
                         ["nodes[3].rotation", "unit"]),
    "scale of two": (put(["nodes", 3, "scale"], [1, 1]), ["nodes[3].scale", "2"]),
    "translation a string": (put(["nodes", 1, "translation"], "far"),
                             ["nodes[1].translation", "far"]),
    "translation of words": (put(["nodes", 1, "translation"], [0, "1", 0]),
                             ["nodes[1].translation[1]", "not a number"]),
    "translation huge": (put(["nodes", 1, "translation"], [0, 1e300, 0]),
                         ["nodes[1].translation[1]", "1e+300"]),
    "matrix of 15": (put(["nodes", 3], {"matrix": [1] * 15}), ["nodes[3].matrix", "15"]),
    "matrix and scale": (put(["nodes", 3, "matrix"], [1, 0, 0, 0] * 4), ["nodes[3]", "both"]),
    "transforms overflow": (lambda d: (d["nodes"][0].update(scale=[1e8, 1, 1]),
                                       d["nodes"][3].update(scale=[1e8, 1, 1])),
                            ["nodes[3]", "range"]),
    "vertices overflow": (lambda d: d["nodes"][0].update(translation=[0, 9e8, 0],
                                                         scale=[1, 9e8, 1]),
                          ["meshes[0].primitives[0]", "POSITION"]),
    "light beyond": (put(["nodes", 1, "extensions", "KHR_lights_punctual", "light"], 2),
                     ["nodes[1]", "light", "2"]),
    "light missing": (put(["nodes", 1, "extensions", "KHR_lights_punctual"], {}),
                      ["'light' is missing"]),
    "light type": (put(LIGHT + ["type"], "area"), ["lights[0].type", "area"]),
    "light type missing": (put(LIGHT + ["type"], ...), ["lights[0]", "'type'"]),
    "light color of two": (put(LIGHT + ["color"], [1, 1]), ["lights[0].color"]),
    "light color negative": (put(LIGHT + ["color"], [1, -1, 1]), ["lights[0].color[1]", "-1"]),
    "light intensity negative": (put(LIGHT + ["intensity"], -5), ["lights[0].intensity", "-5"]),
    "light intensity a string": (put(LIGHT + ["intensity"], "bright"),
                                 ["lights[0].intensity", "bright"]),
    "light range 0": (put(LIGHT + ["range"], 0), ["lights[0].range", "0"]),
    "lights no array": (put(["extensions", "KHR_lights_punctual", "lights"], {}),
                        ["lights", "array"]),
    "spot missing": (put(SPOT[:-1] + ["spot"], ...), ["lights[1]", "'spot'"]),
    "spot wide": (put(SPOT + ["outerConeAngle"], 2), ["outerConeAngle", "2"]),
    "spot inner beyond outer": (put(SPOT + ["innerConeAngle"], 0.6), ["innerConeAngle", "0.6"]),
    "spot inner negative": (put(SPOT + ["innerConeAngle"], -0.1), ["innerConeAngle", "-0.1"]),
    "camera type": (put(["cameras", 0, "type"], "fisheye"), ["cameras[0].type", "fisheye"]),
    "camera without lens": (put(["cameras", 0, "perspective"], ...), ["cameras[0]", "perspective"]),
    "camera yfov 0": (put(LENS + ["yfov"], 0), ["yfov", "0"]),
    "camera yfov 4": (put(LENS + ["yfov"], 4), ["yfov", "4"]),
    "camera aspect negative": (put(LENS + ["aspectRatio"], -1), ["aspectRatio", "-1"]),
    "camera znear missing": (put(LENS + ["znear"], ...), ["znear"]),
    "camera xmag 0": (put(ORTHO + ["xmag"], 0), ["xmag", "0"]),
    "camera zfar a string": (put(ORTHO + ["zfar"], "9"), ["zfar", "9"]),
    "camera zfar at znear": (put(ORTHO + ["znear"], 9), ["zfar", "znear", "9"]),
    "camera zfar before znear": (put(LENS + ["zfar"], 0.05), ["zfar", "0.05", "znear", "0.1"]),
    "base color of three": (put(PBR + ["baseColorFactor"], [1, 1, 1]), ["baseColorFactor", "3"]),
    "base color above 1": (put(PBR + ["baseColorFactor"], [1, 2, 1, 1]),
                           ["baseColorFactor[1]", "2"]),
    "metallic above 1": (put(PBR + ["metallicFactor"], 1.5), ["metallicFactor", "1.5"]),
    "roughness negative": (put(PBR + ["roughnessFactor"], -0.1), ["roughnessFactor", "-0.1"]),
    "emissive negative": (put(MATERIAL + ["emissiveFactor"], [0, 0, -3]),
                          ["emissiveFactor[2]", "-3"]),
    "glossiness above 1": (put(MATERIAL + ["extensions", "KHR_materials_pbrSpecularGlossiness"],
                               {"glossinessFactor": 1.5}), ["glossinessFactor", "1.5"]),
    "variant beyond": (
        lambda d: (put(["extensions", "KHR_materials_variants"], {"variants": [{"name": "a"}]})(d),
                   put(PRIMITIVE + ["extensions"], {"KHR_materials_variants": {
                       "mappings": [{"material": 0, "variants": [1]}]}})(d)),
        ["mappings[0].variants[0]", "no variant 1"]),
    "variant material beyond": (put(PRIMITIVE + ["extensions"], {"KHR_materials_variants": {
        "mappings": [{"material": 9, "variants": []}]}}), ["mappings[0].material", "9"]),
    "visibility a number": (put(["nodes", 0, "extensions"],
                                {"KHR_node_visibility": {"visible": 0}}),
                            ["nodes[0].extensions.KHR_node_visibility.visible", "0"]),
    "emissive strength negative": (put(MATERIAL + ["extensions", "KHR_materials_emissive_strength",
                                                   "emissiveStrength"], -1),
                                   ["emissiveStrength", "-1"]),
    "specular above 1": (put(MATERIAL + ["extensions", "KHR_materials_specular", "specularFactor"],
                             2),
                         ["specularFactor", "2"]),
    "double sided a number": (put(MATERIAL + ["doubleSided"], 1), ["doubleSided", "1"]),
    "alpha mode": (put(MATERIAL + ["alphaMode"], "GLASS"), ["alphaMode", "GLASS"]),
    "texture beyond": (put(PBR + ["baseColorTexture", "index"], 1),
                       ["baseColorTexture.index", "1"]),
    "texture source beyond": (put(["textures", 0, "source"], 7), ["textures[0].source", "7"]),
    "texCoord beyond": (put(PBR + ["baseColorTexture", "texCoord"], 16),
                        ["baseColorTexture.texCoord", "16"]),
    "texCoord text": (put(PBR + ["baseColorTexture", "texCoord"], "0"), ["texCoord", '"0"']),
    "coordinates scalar": (put(PRIMITIVE + ["attributes", "TEXCOORD_0"], 1),
                           ["attributes.TEXCOORD_0", "accessor 1", "VEC2"]),
    "coordinates infinite": (lambda d: (put(PRIMITIVE + ["attributes", "TEXCOORD_0"], 3)(d),
                                        d["accessors"].append(
                                            {"bufferView": 2, "componentType": 5126, "count": 4,
                                             "type": "VEC2"}),
                                        d["bufferViews"].append({"buffer": 1, "byteLength": 32}),
                                        d["buffers"].append({"byteLength": 32, "uri": INFINITIES})),
                             ["attributes.TEXCOORD_0", "element 0", "finite"]),
    "too few coordinates": (put(["accessors", 2, "count"], 3), ["TEXCOORD_0", "3", "4"]),
    "colours of two": (put(PRIMITIVE + ["attributes", "COLOR_0"], 2),
                       ["attributes.COLOR_0", "accessor 2", "VEC3 or VEC4"]),
    "too few colours": (lambda d: (put(PRIMITIVE + ["attributes", "COLOR_0"], 3)(d),
                                   d["accessors"].append({"bufferView": 0, "componentType": 5126,
                                                          "count": 2, "type": "VEC3"})),
                        ["attributes.COLOR_0", "2", "4"]),
    "wrap mode": (put(["samplers", 0, "wrapS"], 5), ["samplers[0].wrapS", "5"]),
    "magFilter": (put(["samplers", 0, "magFilter"], 9987), ["samplers[0].magFilter", "9987"]),
    "minFilter": (put(["samplers", 0, "minFilter"], "LINEAR"), ["samplers[0].minFilter"]),
    "transform of three": (put(PBR + ["baseColorTexture", "extensions"],
                               {"KHR_texture_transform": {"scale": [1, 1, 1]}}),
                           ["KHR_texture_transform.scale", "3"]),
    "transform text": (put(PBR + ["baseColorTexture", "extensions"],
                           {"KHR_texture_transform": {"rotation": "90"}}),
                       ["KHR_texture_transform.rotation", '"90"']),
    "webp beyond": (put(["textures", 0, "extensions"], {"EXT_texture_webp": {"source": 1}}),
                    ["textures[0].extensions.EXT_texture_webp.source", "1"]),
    "ior below 1": (put(MATERIAL + ["extensions", "KHR_materials_ior"], {"ior": 0.5}),
                    ["KHR_materials_ior.ior", "0.5"]),
    "specular colour negative": (put(MATERIAL + ["extensions", "KHR_materials_specular"],
                                     {"specularColorFactor": [1, -1, 1]}),
                                 ["specularColorFactor[1]", "-1"]),
    "image a folder": (put(["images", 0, "uri"], "."), ["images[0].uri"]),
    "image empty": (put(["images", 0, "uri"], "empty.png"), ["images[0]", "0 bytes"]),
    "image text": (put(["images", 0, "uri"], "text.png"), ["images[0]", "no PNG"]),
    "image cut off": (put(["images", 0, "uri"], "cut%20off.png"), ["images[0]", "decoded"]),
    "image rows missing": (put(["images", 0, "uri"], "rows missing.png"),
                           ["images[0]", "decoded"]),
    "image too wide": (put(["images", 0, "uri"], "wide.png"), ["images[0]", "60000", "16384"]),
    "image too large": (put(["images", 0, "uri"], "huge.png"), ["images[0]", "16000", "67108864"]),
    "image base64": (put(["images", 0, "uri"], "data:image/webp;base64,%%%"),
                     ["images[0]", "base64"]),
    "image no base64": (put(["images", 0, "uri"], "data:image/png,abc"),
                        ["images[0].uri", "base64"]),
    "image in text broken": (put(["images", 0, "uri"], "data:image/png;base64,iVBORw0KGgo="),
                             ["images[0]", "decoded"]),
    "image of a view": (put(["images", 0], {"bufferView": 0}), ["images[0]", "48 bytes"]),
    "image of a file and a view": (put(["images", 0, "bufferView"], 0), ["images[0]", "both"]),
    "image outside": (put(["images", 0, "uri"], "../../secret.png"), ["images[0].uri", "outside"]),
    "meshes of numbers": (put(["meshes"], [1]), ["meshes[0]", "not an object"]),
    "mesh without primitives": (put(["meshes", 0, "primitives"], []), ["meshes[0].primitives"]),
    "primitive material beyond": (put(PRIMITIVE + ["material"], 1),
                                  ["primitives[0].material", "1"]),
    "primitive mode": (put(PRIMITIVE + ["mode"], 9), ["primitives[0].mode", "9"]),
    "primitive indices beyond": (put(PRIMITIVE + ["indices"], 2), ["primitives[0].indices", "2"]),
    "attributes missing": (put(PRIMITIVE + ["attributes"], ...), ["attributes"]),
    "attribute beyond": (put(PRIMITIVE + ["attributes", "POSITION"], 4), ["POSITION", "4"]),
    "attribute negative": (put(PRIMITIVE + ["attributes", "POSITION"], -1), ["POSITION", "-1"]),
    "positions of scalars": (put(PRIMITIVE + ["attributes"], {"POSITION": 1}),
                             ["POSITION", "VEC3"]),
    "indices of vectors": (put(PRIMITIVE + ["indices"], 0), ["indices", "SCALAR"]),
    "indices of floats": (lambda d: (d["accessors"].append({"bufferView": 0, "componentType": 5126,
                                                            "count": 3, "type": "SCALAR"}),
                                     d["meshes"][0]["primitives"][0].update(indices=2)),
                          ["indices", "unsigned"]),
    "corners no triangles": (put(INDEX + ["count"], 5), ["5 corners"]),
    "index beyond the vertices": (patched(48 + 4, struct.pack("<H", 4)), ["element 2", "4"]),
    "normals too few": (lambda d: (d["accessors"].append(dict(d["accessors"][0], count=3)),
                                   d["meshes"][0]["primitives"][0]["attributes"].update(NORMAL=3)),
                        ["NORMAL", "3 values for 4"]),
    "position not a number": (patched(4, NAN), ["POSITION", "element 0"]),
    "position infinite": (patched(24, INF), ["POSITION", "element 2"]),
    "accessor type": (put(POSITION + ["type"], "VEC5"), ["accessors[0].type", "VEC5"]),
    "accessor component type": (put(POSITION + ["componentType"], 5127), ["componentType", "5127"]),
    "accessor count missing": (put(POSITION + ["count"], ...), ["accessors[0]", "'count'"]),
    "accessor count 0 beyond": (lambda d: (put(POSITION + ["count"], 0)(d),
                                           put(POSITION + ["byteOffset"], 2**63)(d)),
                                ["accessors[0]", str(2**63)]),
    "accessor count negative": (put(POSITION + ["count"], -3), ["accessors[0].count", "-3"]),
    "accessor count 5": (put(POSITION + ["count"], 5), ["accessors[0]", "count 5"]),
    "accessor count 2^31": (put(POSITION + ["count"], 2**31), ["accessors[0]", str(2**31)]),
    "accessor count 2^62": (put(POSITION + ["count"], 2**62), ["accessors[0]", str(2**62)]),
    "accessor count 2^64": (put(POSITION + ["count"], 2**64), ["accessors[0].count"]),
    "accessor count 1e300": (put(POSITION + ["count"], 1e300), ["accessors[0].count"]),
    "accessor offset beyond": (put(POSITION + ["byteOffset"], 48), ["accessors[0]", "48"]),
    "accessor offset 2^63": (put(POSITION + ["byteOffset"], 2**63), ["accessors[0]", str(2**63)]),
    "accessor view beyond": (put(POSITION + ["bufferView"], 2), ["accessors[0].bufferView", "2"]),
    "accessor without view": (lambda d: (put(POSITION + ["bufferView"], ...)(d),
                                         put(POSITION + ["count"], 1 << 30)(d)),
                              ["accessors[0].count", str(1 << 30)]),
    "sparse count 0": (sparse(count=0), ["accessors[0].sparse.count", "0"]),
    "sparse count beyond": (sparse(count=9), ["accessors[0].sparse.count", "9"]),
    "sparse indices of float": (sparse(componentType=5126),
                                ["sparse.indices.componentType", "5126"]),
    "sparse indices beyond": (sparse(count=3), ["sparse.indices", "bufferView 2"]),
    "sparse values with a stride": (sparse(stride=12), ["sparse.values", "byteStride"]),
    "sparse element beyond": (lambda d: (sparse(offset=4)(d), put(POSITION + ["count"], 2)(d)),
                              ["POSITION", "sparse element 0 is number 2"]),
    "meshopt mode": (compressed(mode="CUBES"), ["EXT_meshopt_compression.mode", "CUBES"]),
    "meshopt filter": (compressed(filter="NOISE"), ["EXT_meshopt_compression.filter", "NOISE"]),
    "meshopt filter's stride": (compressed(filter="OCTAHEDRAL"), ["byteStride", "12"]),
    "meshopt stride": (compressed(byteStride=6), ["byteStride", "6"]),
    "meshopt count": (compressed(count=5), ["count", "5 elements"]),
    "meshopt buffer beyond": (compressed(byteOffset=50), ["EXT_meshopt_compression", "50"]),
    "meshopt without data": (compressed(buffer=1), ["EXT_meshopt_compression.buffer", "no data"]),
    "meshopt bytes": (compressed(), ["bufferViews[0]", "do not hold 4 ATTRIBUTES"]),
    "meshopt bomb": (compressed(byteLength=1, count=1 << 20, whole=12 << 20),
                     ["byteLength", "1 bytes cannot hold"]),
    "fallback buffer without compression": (
        lambda d: (compressed()(d), put(VIEW + ["extensions"], ...)(d)),
        ["bufferViews[0]", "no data"]),
    "draco strip": (draco(mode=5), ["primitives[0].mode", "5"]),
    "draco view beyond": (draco(view=9), ["KHR_draco_mesh_compression.bufferView", "9"]),
    "draco bytes": (draco(), ["meshes[0].primitives[0]", "no Draco data"]),
    "draco version": (draco(b"DRACO\1\3\1\0\0\0\2\4"), ["1.3"]),
    "draco points": (draco(b"DRACO\2\2\0\0\0\0\2\4"), ["no mesh"]),
    "draco metadata end early": (draco(b"DRACO\2\2\1\0\0\x80\0\1\1a\x7fb\0"), ["end early"]),
    "draco metadata of a deep tree":
        (draco(b"DRACO\2\2\1\0\0\x80\0" + 200 * b"\0\1\0"), ["end early"]),
    "draco triangles": (draco(b"DRACO\2\2\1\0\0\0\x82\1\4"), ["130 triangles"]),
    "draco vertices": (draco(b"DRACO\2\2\1\0\0\0\2\5"), ["5 vertices"]),
    "draco edgebreaker's triangles": (draco(b"DRACO\2\2\1\1\0\0\0\4\5"), ["5 triangles"]),
    "draco ends early": (draco(b"DRACO\2\2\1\0\0\0\x82"), ["end early"]),
    "draco without connectivity": (draco(b"DRACO\2\2\1\0\0\0\2\4"), ["KHR_draco_mesh_compression"]),
    "draco bomb": (lambda d: (draco()(d), put(INDEX + ["bufferView"], ...)(d),
                              put(INDEX + ["count"], 3 * 5_500_000)(d), d["meshes"][0].update(
                                  primitives=d["meshes"][0]["primitives"] * 2)),
                   ["would decompress to more than"]),
    "instances of different numbers": (
        lambda d: d["nodes"][0].update(extensions={"EXT_mesh_gpu_instancing": {
            "attributes": {"TRANSLATION": 0, "SCALE": 3}}}) or d["accessors"].append(
                dict(d["accessors"][0], count=3)),
        ["EXT_mesh_gpu_instancing.SCALE", "3 values for 4"]),
    "image in a compressed view": (lambda d: (compressed()(d), put(["images", 0], {
        "bufferView": 0, "mimeType": "image/png"})(d)), ["images[0].bufferView", "compressed"]),
    "image of a short EXIF": (put(["images", 0, "uri"], "exif.webp"),
                              ["images[0]", "EXIF", "4 bytes"]),
    "animated image": (put(["images", 0, "uri"], "data:image/webp;base64," + base64.b64encode(
        b"RIFF\x12\0\0\0WEBPVP8X\x0a\0\0\0\2" + bytes(9)).decode()), ["images[0]", "animation"]),
    "sparse offset beyond int": (put(POSITION + ["sparse"], {
        "count": 1, "indices": {"bufferView": 0, "byteOffset": 2**31, "componentType": 5123},
        "values": {"bufferView": 0}}), ["byteOffset", str(2**31), "is more than"]),
    "a file twice": (lambda d: d.update(buffers=d["buffers"] + 2 * [
        {"byteLength": 4, "uri": "texture.png"}]), ["buffers[2].uri", "texture.png"]),
    "a file twice by two names": (lambda d: d.update(buffers=d["buffers"] + [
        {"byteLength": 4, "uri": "texture.png"}, {"byteLength": 4, "uri": "./%74exture.png"}]),
                                  ["buffers[2].uri", "another buffer"]),
    "buffer data of no base64": (put(BUFFER + ["uri"], "data:application/octet-stream;base64,AA*A"),
                                 ["buffers[0].uri", "base64"]),
    "morph targets beyond all time": (
        lambda d: (d["accessors"].append({"componentType": 5126, "type": "VEC3",
                                          "count": 1 << 24}),
                   put(POSITION, d["accessors"][-1])(d),
                   put(PRIMITIVE + ["targets"], [{"POSITION": 0}] * 1000)(d)),
        ["morph targets", "steps"]),
    "instances beyond memory": (many_instances(64, 1 << 24, "TRANSLATION"),
                                ["instances", "GiB of memory"]),
    "flat copies beyond memory": (many_instances(1, 1 << 20, "SCALE"),
                                  ["triangles", "GiB of memory"]),
    "accessor min of two": (put(POSITION + ["min"], [0, 0]), ["accessors[0].min", "2"]),
    "view buffer beyond": (put(VIEW + ["buffer"], 1), ["bufferViews[0].buffer", "1"]),
    "view length 0": (put(VIEW + ["byteLength"], 0), ["bufferView 0 of 0 bytes"]),
    "view length beyond": (put(VIEW + ["byteLength"], 61), ["bufferViews[0]", "61"]),
    "view length 2^64 - 1": (put(VIEW + ["byteLength"], 2**64 - 1),
                             ["bufferViews[0]", str(2**64 - 1)]),
    "view offset overflows": (put(VIEW + ["byteOffset"], 2**64 - 8),
                              ["bufferViews[0]", str(2**64 - 8)]),
    "view stride 2": (put(VIEW + ["byteStride"], 2), ["byteStride", "2"]),
    "view stride 8": (put(VIEW + ["byteStride"], 8), ["byteStride", "8"]),
    "view stride 13": (put(VIEW + ["byteStride"], 13), ["byteStride", "13"]),
    "view stride 256": (put(VIEW + ["byteStride"], 256), ["byteStride", "256"]),
    "buffer length missing": (put(BUFFER + ["byteLength"], ...), ["buffers[0]", "'byteLength'"]),
    "buffer shorter than said": (put(BUFFER + ["byteLength"], 1000), ["uffer"]),
    "buffer 2^62 bytes": (put(BUFFER + ["byteLength"], 2**62), ["uffer"]),
    "buffer without uri": (put(BUFFER + ["uri"], ...), ["bufferViews[0]", "buffer 0", "no data"]),
    "buffer uri absolute": (put(BUFFER + ["uri"], "/etc/passwd"), ["buffers[0].uri", "outside"]),
    "buffer uri upwards": (put(BUFFER + ["uri"], "../data.bin"), ["buffers[0].uri", "outside"]),
    "buffer uri upwards, encoded": (put(BUFFER + ["uri"], "%2e%2e/data.bin"),
                                    ["buffers[0].uri", "outside"]),
    "buffer uri by network": (put(BUFFER + ["uri"], "http://localhost/data.bin"),
                              ["buffers[0].uri"]),
    "buffer uri down and up": (put(BUFFER + ["uri"], "folder/../../data.bin"),
                               ["buffers[0].uri", "outside"]),
    "buffer uri up and in again": (put(BUFFER + ["uri"], "../scenes/data.bin"),
                                   ["buffers[0].uri", "outside"]),
    "buffer uri that ends early": (put(BUFFER + ["uri"], "../data.bin%zz/../scenes/texture.png"),
                                   ["buffers[0].uri", "outside"]),
    "buffer uri of a NUL": (put(BUFFER + ["uri"], "texture.png%00.bin"),
                            ["buffers[0].uri", "control"]),
    "buffer uri of a raw NUL": (put(BUFFER + ["uri"], "texture.png\0.bin"),
                                ["buffers[0].uri", "control"]),
    "buffer uri of a line break": (put(BUFFER + ["uri"], "texture%0a.png"),
                                   ["buffers[0].uri", "control"]),
    "buffer uri of a drive": (put(BUFFER + ["uri"], "C:/data.bin"), ["buffers[0].uri", "colon"]),
    "buffer uri of a drive, encoded": (put(BUFFER + ["uri"], "c%3A/data.bin"),
                                       ["buffers[0].uri", "colon"]),
    "buffer uri by backslashes": (put(BUFFER + ["uri"], "..\\data.bin"),
                                  ["buffers[0].uri", "backslash"]),
    "buffer uri by backslashes, encoded": (put(BUFFER + ["uri"], "..%5cdata.bin"),
                                           ["buffers[0].uri", "backslash"]),
    "buffer uri absolute, encoded": (put(BUFFER + ["uri"], "%2fetc%2fpasswd"),
                                     ["buffers[0].uri", "outside"]),
    "buffer uri encoded twice": (put(BUFFER + ["uri"], "%252e%252e/data.bin"),
                                 ["buffers[0].uri", "no such file"]),
    "buffer uri of a scheme": (put(BUFFER + ["uri"], "file:data.bin"), ["buffers[0].uri", "colon"]),
    "buffer uri too long": (put(BUFFER + ["uri"], 300 * "a"), ["buffers[0].uri", "aaa..."]),
    "buffer uri by a link": (put(BUFFER + ["uri"], "link.bin"),
                             ["buffers[0].uri", "outside", "link"]),
    "buffer uri by a linked folder": (put(BUFFER + ["uri"], "up/data.bin"),
                                      ["buffers[0].uri", "outside"]),
    "buffer uri in a circle": (put(BUFFER + ["uri"], "circle.bin"),
                               ["buffers[0].uri", "circle.bin"]),
    "image uri that ends early": (put(["images", 0, "uri"], "../data.bin%zz/../scenes/texture.png"),
                                  ["images[0].uri", "outside"]),
    "image uri by a link": (put(["images", 0, "uri"], "link.bin"),
                            ["images[0].uri", "outside", "link"]),
    "image uri by backslashes": (put(["images", 0, "uri"], "a\\b.png"),
                                 ["images[0].uri", "backslash"]),
    "buffer uri of no file": (put(BUFFER + ["uri"], "nowhere.bin"),
                              ["buffers[0].uri", "nowhere.bin"]),
    "buffer uri the folder": (put(BUFFER + ["uri"], "."), ["buffers[0].uri"]),
    "buffer uri empty": (put(BUFFER + ["uri"], ""), ["buffers[0].uri"]),
    "buffer uri a number": (put(BUFFER + ["uri"], 5), ["buffers[0].uri", "5"]),
    "buffer data not base64": (put(BUFFER + ["uri"], "data:application/octet-stream,abc"),
                               ["buffers[0].uri", "base64"]),
    "buffer data of another type": (put(BUFFER + ["uri"], "data:text/html;base64,AAAA"),
                                    ["buffers[0].uri", "text/html"]),
    "skin matrices beyond": (put(["skins", 0, "inverseBindMatrices"], 3),
                             ["inverseBindMatrices", "3"]),
    "animation sampler beyond": (put(["animations"], [{"samplers": [], "channels": [
        {"sampler": 0, "target": {"node": 0}}]}]), ["animations[0].channels[0].sampler", "0"]),
    "animation input beyond": (put(["animations"], [{"samplers": [{"input": 9, "output": 0}],
                                                     "channels": []}]), ["samplers[0].input", "9"]),
    "morph target beyond": (put(PRIMITIVE + ["targets"], [{"POSITION": 8}]),
                            ["targets[0].POSITION", "8"]),
    "light too bright": (put(LIGHT + ["intensity"], 3e38), ["lights[0]", "3e+38"]),
    "light infinitely bright": (
        lambda d: d["extensions"]["KHR_lights_punctual"]["lights"][0].update(
            color=[1e10, 1, 1], intensity=3e38), ["lights[0]", "inf"]),
    "emission too bright": (lambda d: (d["materials"][0].update(emissiveFactor=[1, 1, 1]),
                                       d["materials"][0]["extensions"][
                                           "KHR_materials_emissive_strength"].update(
                                               emissiveStrength=1e30)), ["materials[0]", "1e+30"]),
    "vertices far away": (put(["nodes", 0, "translation"], [2e9, 0, 0]),
                          ["nodes[0]", "2000000000"]),
    "skin joint beyond": (put(["skins", 0, "joints"], [8]), ["skins[0].joints[0]", "8"]),
}

TEXT = json.dumps(valid()).encode()
GLB_TEXT = json.dumps(valid()).encode() + b" " * (-len(TEXT) % 4)

# name: (the file's bytes, words)
FILES = {
    "empty.gltf": (b"", ["JSON"]),
    "cut off.gltf": (TEXT[:200], ["JSON"]),
    "no JSON.gltf": (b"solid cube\nfacet normal 0 0 1\n", ["JSON"]),
    "an array.gltf": (b"[1, 2]", ["not an object"]),
    "a number.gltf": (b"17", ["not an object"]),
    "no UTF-8.gltf": (TEXT.replace(b"texture.png", b"t\xff\xfe.png"), ["JSON"]),
    "brackets.gltf": (b"[" * 20000 + b"]" * 20000, ["nested deeper"]),
    "braces.gltf": (b'{"a":' * 20000 + b"1" + b"}" * 20000, ["nested deeper"]),
    "brackets in extras.gltf": (TEXT[:-1] + b', "extras": ' + b"[" * 300 + b"]" * 300 + b"}",
                                ["nested deeper"]),
    "number 1e999.gltf": (TEXT.replace(b'"intensity": 5', b'"intensity": 1e999'), ["JSON"]),
    "number NaN.gltf": (TEXT.replace(b'"intensity": 5', b'"intensity": NaN'), ["JSON"]),
    "header only.glb": (b"glTF", ["glb header"]),
    "header cut off.glb": (glb()[:16], ["glb header"]),
    "version 1.glb": (glb(version=1), ["glb header", "version 1", "gltf-pipeline -i"]),
    "length long.glb": (glb(length=10**6), ["glb header", "1000000"]),
    "length short.glb": (glb(length=40), ["glb header", "40"]),
    "first chunk BIN.glb": (glb(chunks=[(0x004E4942, DATA)]), ["chunk 0"]),
    "second chunk JSON.glb": (glb(chunks=[(0x4E4F534A, GLB_TEXT), (0x4E4F534A, GLB_TEXT)]),
                              ["chunk 1"]),
    "chunk beyond.glb": (b"glTF" + struct.pack("<IIII", 2, 24, 4000, 0x4E4F534A) + b"{}  ",
                         ["chunk 0", "4000"]),
    "chunk header cut off.glb": (b"glTF" + struct.pack("<IIII", 2, 28, 4, 0x4E4F534A) +
                                 b"{}  " + b"\0\0\0\0",
                                 ["chunk 1"]),
    "asset missing.glb": (b"glTF" + struct.pack("<IIII", 2, 22, 2, 0x4E4F534A) + b"{}",
                          ["'asset'"]),
    "without binary.glb": (glb(chunks=[(0x4E4F534A, json.dumps(
        dict(valid(), buffers=[{"byteLength": 60}])).encode() + b"   "[:(-len(json.dumps(
            dict(valid(), buffers=[{"byteLength": 60}]))) % 4)])]), ["uffer"]),
    "binary too short.glb": (glb(dict(valid())).replace(b'"byteLength": 60}]',
                                                        b'"byteLength": 90}]'),
                             ["byteLength", "90"]),
}


def refused(program, path, words):
    """None if the file is refused as it should be, otherwise what is wrong."""
    image = path.parent / (path.name + ".png")
    command = [program, "render", str(path), "--quiet", "-o", str(image)]
    try:
        run = subprocess.run(command, capture_output=True, text=True, timeout=120, errors="replace")
    except subprocess.TimeoutExpired:
        return "it hangs"
    if run.returncode not in (1, 2, 3):
        return f"exit code {run.returncode}: {run.stderr[-2000:]}"
    lines = run.stderr.splitlines()
    if len(lines) != 1 or not lines[0].startswith(f"error: {path}: "):
        return f"no single line that names the file: {run.stderr[-2000:]}"
    missing = [word for word in words if word not in lines[0].replace(f"error: {path}: ", "")]
    if missing:
        return f"the message lacks {missing}: {lines[0]}"
    if image.exists():
        return "an image was made"
    return None


def main():
    program = sys.argv[1]
    temporary = tempfile.TemporaryDirectory()
    folder = pathlib.Path(sys.argv[2] if len(sys.argv) > 2 else temporary.name)
    inside = folder / "scenes"  # so that ../data.bin exists and is still refused
    inside.mkdir(parents=True, exist_ok=True)
    (folder / "data.bin").write_bytes(DATA)
    for name, data in IMAGES.items():
        (inside / name).write_bytes(data)
    for name, target in (("link.bin", "../data.bin"), ("up", ".."), ("circle.bin", "circle.bin")):
        (inside / name).unlink(missing_ok=True)
        (inside / name).symlink_to(target)
    cases = {}
    for name, (change, words) in CHANGES.items():
        document = valid()
        change(document)
        cases[name + ".gltf"] = (json.dumps(document).encode(), words)
    cases.update(FILES)
    good = inside / "valid.gltf"
    good.write_text(json.dumps(valid()))
    image = inside / "valid.png"
    subprocess.run([program, "render", str(good), "--quiet", "--height", "8", "-o", str(image)],
                   check=True, env=dict(os.environ, ASAN_OPTIONS="detect_leaks=0"))
    for name, (data, _) in cases.items():
        (inside / name).write_bytes(data)
    # A file that does not exist, and a folder, are refused alike.
    tries = [(inside / name, words) for name, (_, words) in cases.items()]
    tries += [(inside / "none.glb", []), (inside, [])]
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        results = list(pool.map(lambda case: refused(program, *case), tries))
    for (path, _), wrong in zip(tries, results):
        if wrong:
            print(f"{path.name}: {wrong}")
    failed = sum(wrong is not None for wrong in results)
    print(f"{len(tries) - failed} passed, {failed} failed")
    sys.exit(failed != 0)


if __name__ == "__main__":
    main()
