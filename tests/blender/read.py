"""Lets Blender itself (bpy 5.0.1) open an Alembic file, and hands out what it holds.

    read.py FILE.abc FOLDER

Writes for every object of curves the points of each (int32) and all positions (float32, x y z) to FOLDER, as Blender holds them
before its object's transform: in the file's unit, Y up turned to Z up. Prints one JSON object: name of the object to its numbers,
the names of the two files, its attributes and its transform; meshes with their numbers and the mean direction of their faces away
from their middle.
"""

import array
import json
import pathlib
import sys

import bpy


def curves(data, folder, number):
    counts = array.array("i", bytes(4 * len(data.curves)))
    positions = array.array("f", bytes(12 * len(data.points)))
    offsets = array.array("i", bytes(4 * (len(data.curves) + 1)))
    data.curve_offset_data.foreach_get("value", offsets)
    for i in range(len(counts)):
        counts[i] = offsets[i + 1] - offsets[i]
    data.attributes["position"].data.foreach_get("vector", positions)
    files = {"counts": counts, "positions": positions}
    for name, values in files.items():
        (folder / f"{number}.{name}").write_bytes(values.tobytes())
    radius = data.attributes.get("radius")
    return {
        "curves": len(data.curves),
        "points": len(data.points),
        "counts_file": str(folder / f"{number}.counts"),
        "positions_file": str(folder / f"{number}.positions"),
        "attributes": sorted(data.attributes.keys()),
        "first_radius": radius.data[0].value if radius else None,
        "types": sorted({curve_type.value for curve_type in data.attributes["curve_type"].data})
        if "curve_type" in data.attributes
        else None,
    }


def mesh(data):
    middle = sum((vertex.co for vertex in data.vertices), start=data.vertices[0].co * 0) / len(data.vertices)
    outwards = sum(1 for polygon in data.polygons if polygon.normal.dot(polygon.center - middle) > 0)
    return {
        "vertices": len(data.vertices),
        "polygons": len(data.polygons),
        "outwards": outwards,
        "uvs": len(data.uv_layers),
    }


def main():
    file, folder = sys.argv[1], pathlib.Path(sys.argv[2])
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.wm.alembic_import(filepath=file, as_background_job=False)
    found = {}
    for number, thing in enumerate(sorted(bpy.data.objects, key=lambda thing: thing.name)):
        entry = {"type": thing.type, "matrix": [list(row) for row in thing.matrix_world]}
        entry["parent"] = thing.parent.name if thing.parent else None
        if thing.type == "CURVES":
            entry.update(curves(thing.data, folder, number))
        elif thing.type == "MESH":
            entry.update(mesh(thing.data))
        found[thing.name] = entry
    print("BLENDER " + json.dumps(found))


main()
