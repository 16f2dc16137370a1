"""After how many bytes files of `build --profile stream` and streams alone can show a first picture: of a .glb, once its
document and the geometry, skins and targets of what the scene shows are there; of a .lods, after its first chunk. Images are
not waited for. The limit is 4,096 bytes or a hundredth of the file, whichever is more.

  python3 bench/stream/first_picture.py --program PROGRAM [--effort N] [--strict] [--misses] MODEL|FOLDER …

Of a folder all models are taken, but for those in folders named "nasty" and "gltf-invalid". With --strict it fails where one
misses its limit, or cannot be built; with --misses only those lines are printed.
"""

import argparse
import json
import os
import struct
import subprocess
import sys
import tempfile

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "tests", "python"))
from compact_header import Header  # noqa: E402

MODELS = (".obj", ".ply", ".stl", ".off", ".glb", ".gltf")
LEFT_OUT = ("nasty", "gltf-invalid")


def limit_of(size):
    return max(4096, size // 100)


def shown_nodes(gltf):
    """The nodes that some scene shows; all where none does."""
    waiting = [node for scene in gltf.get("scenes", []) for node in scene.get("nodes", [])]
    found = set()
    while waiting:
        node = waiting.pop()
        found.add(node)
        waiting += gltf["nodes"][node].get("children", [])
    return [gltf["nodes"][node] for node in sorted(found)] or gltf.get("nodes", [])


def needed_accessors(gltf):
    nodes = shown_nodes(gltf)
    for mesh in {node["mesh"] for node in nodes if "mesh" in node}:
        for primitive in gltf["meshes"][mesh]["primitives"]:
            yield from primitive["attributes"].values()
            yield from (primitive[key] for key in ("indices",) if key in primitive)
            for target in primitive.get("targets", []):
                yield from target.values()
    for skin in {node["skin"] for node in nodes if "skin" in node}:
        yield from (value for key, value in gltf["skins"][skin].items() if key == "inverseBindMatrices")


def needed_views(gltf):
    for index in needed_accessors(gltf):
        accessor = gltf["accessors"][index]
        yield from (accessor[key] for key in ("bufferView",) if key in accessor)
    for mesh in {node["mesh"] for node in shown_nodes(gltf) if "mesh" in node}:
        for primitive in gltf["meshes"][mesh]["primitives"]:
            draco = primitive.get("extensions", {}).get("KHR_draco_mesh_compression")
            yield from ([draco["bufferView"]] if draco else [])


def bytes_of_glb(data):
    """Of the document, and of all up to the first picture."""
    size = struct.unpack_from("<I", data, 12)[0]
    gltf = json.loads(data[20 : 20 + size])
    begin = 28 + size  # two headers of chunks, and the file's
    views = [gltf["bufferViews"][view] for view in set(needed_views(gltf))]
    return size, begin + max((view.get("byteOffset", 0) + view["byteLength"] for view in views), default=0)


def bytes_of_lods(data):
    header = Header(data)
    return header.bytes, header.bytes + header.chunks[0].bytes


def models_in(paths):
    for path in paths:
        if not os.path.isdir(path):
            yield path, os.path.basename(path)
        for folder, folders, files in os.walk(path):
            folders[:] = sorted(name for name in folders if name not in LEFT_OUT)
            for name in sorted(files):
                if name.lower().endswith(MODELS):
                    yield os.path.join(folder, name), os.path.relpath(os.path.join(folder, name), path)


def build(options, model, output, *more):
    command = [options.program, "build", model, "-o", output, "-q", "--effort", str(options.effort), *more]
    run = subprocess.run(command, capture_output=True, text=True)
    if run.returncode != 0:
        return None, (run.stderr.strip().splitlines() or ["no word"])[-1]
    with open(output, "rb") as file:
        return file.read(), ""


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--program", required=True)
    parser.add_argument("--effort", type=int, default=3)
    parser.add_argument("--strict", action="store_true")
    parser.add_argument("--misses", action="store_true")
    parser.add_argument("models", nargs="+")
    options = parser.parse_args()
    counts = {"held": 0, "missed": 0, "not built": 0}
    print("| | file | document or header | first picture after | limit | |\n|---|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as folder:
        for model, name in models_in(options.models):
            for kind, measure, more in ((".glb", bytes_of_glb, ("--profile", "stream")), (".lods", bytes_of_lods, ())):
                data, why = build(options, model, os.path.join(folder, "out" + kind), *more)
                if data is None:
                    counts["not built"] += 1
                    print(f"| {name} | | | | | {why} |")
                    break
                begin, first = measure(data)
                held = first <= limit_of(len(data))
                counts["held" if held else "missed"] += 1
                if not held or not options.misses:
                    verdict = "" if held else "**missed**"
                    print(f"| {name}, {kind} | {len(data):,} | {begin:,} | {first:,} | {limit_of(len(data)):,} | {verdict} |", flush=True)
    print(", ".join(f"{count} {what}" for what, count in counts.items()))
    return 1 if options.strict and counts["missed"] + counts["not built"] > 0 else 0


if __name__ == "__main__":
    sys.exit(main())
