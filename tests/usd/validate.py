"""Lets OpenUSD itself (usd-core 26.11) judge and read files, and reports what it saw as JSON.

    validate.py report FILE...     every file: 0 validation errors, extents as computed, all arrays
    validate.py equal A B          the two files hold the same prims, types, values and metadata
    validate.py pairs A B A B...   `report` of all, and `equal` of each pair
    validate.py control            a stage that must NOT pass; fails if the validators let it
    validate.py write FOLDER       files as OpenUSD writes them, for our reader, with their report
    validate.py compose FOLDER     what OpenUSD composes of each root.usd in a folder of FOLDER, and all layers
                                   once more as crate files in a folder NAME_crate beside it

`report`, `pairs`, `write` and `compose` print one JSON object; every other word goes to stderr. Exit code 0 means that
everything held. Arrays are reported by length and SHA-256 of their little-endian bytes.
"""

import hashlib
import json
import pathlib
import struct
import sys

from pxr import Gf, Sdf, Usd, UsdGeom, UsdValidation, Vt


def validation_errors(stage):
    """All errors and warnings of all validators that this OpenUSD has."""
    validators = UsdValidation.ValidationRegistry().GetOrLoadAllValidators()
    if len(validators) < 10:
        raise SystemExit(f"only {len(validators)} validators: this OpenUSD lacks plugins")
    found = UsdValidation.ValidationContext(validators).Validate(stage)
    return [f"{error.GetName()}: {error.GetMessage()}" for error in found]


def flat(value):
    """Numbers of a value, however it is nested, in order."""
    if isinstance(value, (bool, int, float, str)):
        return [value]
    return [number for part in value for number in flat(part)]


def raw(value):
    """The bytes of an array of numbers as it lies in memory, without a detour over Python numbers; None for others."""
    try:
        return bytes(memoryview(value)) if sys.byteorder == "little" else None
    except TypeError:
        return None


def little_endian(type_name, value):
    """The values as our arrays lie in memory; texts end in NUL."""
    data = raw(value)
    if data is not None and not isinstance(value, (str, bytes)):
        return data
    values = flat(value)
    if values and isinstance(values[0], str):
        return b"".join(text.encode() + b"\0" for text in values)
    code = "q" if type_name.startswith("int64") else "i" if type_name.startswith("int") else "f"
    return struct.pack(f"<{len(values)}{code}", *values)


def array_report(attribute, value):
    type_name = str(attribute.GetTypeName())
    data = little_endian(type_name, value)
    report = {"type": type_name, "count": len(value), "sha256": hashlib.sha256(data).hexdigest()}
    if len(data) <= 1 << 16:
        report["bytes"] = data.hex()
    return report


def extent_agrees(prim):
    curves = UsdGeom.BasisCurves(prim)
    if not curves.GetPointsAttr().Get():
        return not curves.GetExtentAttr().HasAuthoredValue()
    computed = UsdGeom.Boundable.ComputeExtentFromPlugins(curves, Usd.TimeCode.Default())
    return curves.GetExtentAttr().Get() == computed


def curves_report(prim):
    curves = UsdGeom.BasisCurves(prim)
    attributes = {
        "counts": curves.GetCurveVertexCountsAttr(),
        "points": curves.GetPointsAttr(),
        "widths": curves.GetWidthsAttr(),
    }
    report = {
        "type": [curves.GetTypeAttr().Get(), curves.GetBasisAttr().Get(), curves.GetWrapAttr().Get()],
        "purpose": UsdGeom.Imageable(prim).ComputePurpose(),
        "widths_interpolation": curves.GetWidthsInterpolation(),
        "material": [str(t) for t in prim.GetRelationship("material:binding").GetTargets()],
    }
    for name, attribute in attributes.items():
        report[name] = array_report(attribute, attribute.Get())
    report["primvars"] = {}
    for primvar in UsdGeom.PrimvarsAPI(prim).GetAuthoredPrimvars():
        entry = array_report(primvar.GetAttr(), primvar.Get())
        entry["interpolation"] = primvar.GetInterpolation()
        report["primvars"][primvar.GetPrimvarName()] = entry
    return report


def stage_report(path):
    stage = Usd.Stage.Open(str(path))
    faults = validation_errors(stage)
    curves = {}
    for prim in stage.Traverse(Usd.PrimAllPrimsPredicate):
        if prim.IsA(UsdGeom.BasisCurves):
            curves[str(prim.GetPath())] = curves_report(prim)
            if not extent_agrees(prim):
                faults.append(f"{prim.GetPath()}: the extent is not what ComputeExtent gives")
    layer = stage.GetRootLayer()
    about = {name: str(value) for name, value in sorted(layer.customLayerData.items())}
    return {
        "faults": faults,
        "default_prim": str(stage.GetDefaultPrim().GetPath()),
        "meters_per_unit": UsdGeom.GetStageMetersPerUnit(stage),
        "up_axis": UsdGeom.GetStageUpAxis(stage),
        "doc": layer.documentation,
        "about": about,
        "curves": curves,
    }


def report(paths):
    reports = {str(path): stage_report(path) for path in paths}
    print(json.dumps(reports, indent=1, sort_keys=True))
    return not any(report["faults"] for report in reports.values())


def layer_values(path):
    """Every field of every spec of a layer, as comparable text, floats by their bits."""
    layer = Sdf.Layer.FindOrOpen(str(path))
    values = {}

    def exact(value):
        if isinstance(value, float):
            return value.hex()
        if isinstance(value, dict):
            return {key: exact(item) for key, item in sorted(value.items())}
        if isinstance(value, (str, bytes, bool, int)) or not hasattr(value, "__len__"):
            return repr(value)
        data = raw(value)
        return [type(value).__name__, data or [exact(item) for item in value]]

    def visit(spec_path):
        spec = layer.GetObjectAtPath(spec_path)
        if spec is None:  # The target of a relationship or connection.
            return
        for key in spec.ListInfoKeys():
            values[f"{spec_path} {key}"] = exact(spec.GetInfo(key))
        if isinstance(spec, Sdf.AttributeSpec):
            values[f"{spec_path} default"] = exact(spec.default)
            values[f"{spec_path} connections"] = str(spec.GetInfo("connectionPaths"))
            times = layer.ListTimeSamplesForPath(spec_path)
            samples = [(t, exact(layer.QueryTimeSample(spec_path, t))) for t in times]
            values[f"{spec_path} samples"] = samples
        if isinstance(spec, Sdf.RelationshipSpec):
            values[f"{spec_path} targets"] = str(spec.GetInfo("targetPaths"))

    layer.Traverse(Sdf.Path.absoluteRootPath, visit)
    return values


def equal(first, second):
    a, b = layer_values(first), layer_values(second)
    different = [key for key in sorted(a.keys() | b.keys()) if a.get(key) != b.get(key)]
    for key in different[:20]:
        print(f"differs: {key}: {str(a.get(key))[:90]} / {str(b.get(key))[:90]}", file=sys.stderr)
    print(f"{len(a)} values compared", file=sys.stderr)
    return not different and len(a) > 0


def control():
    """No default prim, no units, no axis, and an extent that is far too small."""
    stage = Usd.Stage.CreateInMemory()
    stage.GetRootLayer().ImportFromString(
        '#usda 1.0\ndef Xform "A" {\n def BasisCurves "B" {\n int[] curveVertexCounts = [2]\n'
        " point3f[] points = [(0,0,0), (9,9,9)]\n float3[] extent = [(0,0,0), (1,1,1)]\n }\n}\n"
    )
    errors = validation_errors(stage)
    agrees = extent_agrees(stage.GetPrimAtPath("/A/B"))
    print(f"{len(errors)} errors, extent agrees: {agrees}", file=sys.stderr)
    return bool(errors) and not agrees


# ---- files for our reader ------------------------------------------------------------------------


def curves_of_many_types(stage, path, samples_only):
    """Curves with a primvar of every type that readers of hair may meet."""
    curves = UsdGeom.BasisCurves.Define(stage, path)
    counts = [3 + i % 2 for i in range(40)]
    points = [Gf.Vec3f(i * 0.37, i % 7, -(i**0.5)) for i in range(sum(counts))]
    curves.CreateTypeAttr("cubic")
    curves.CreateBasisAttr("bspline")
    curves.CreateWrapAttr("pinned")
    curves.CreateCurveVertexCountsAttr(counts)
    if samples_only:
        curves.GetPointsAttr().Set([p * 2 for p in points], 7.0)
        curves.GetPointsAttr().Set(points, 3.0)
    else:
        curves.CreatePointsAttr(points)
    curves.CreateWidthsAttr([0.5, 0.25, 0.125, 1.0] * (len(points) // 4))
    curves.SetWidthsInterpolation("vertex")
    api, names = UsdGeom.PrimvarsAPI(curves), Sdf.ValueTypeNames
    n = len(counts)
    for name, kind, interpolation, value in [
        ("ints", names.IntArray, "uniform", [i * i for i in range(n)]),
        ("few", names.IntArray, "constant", [-70000]),
        ("longs", names.Int64Array, "uniform", [(i % 3) << 40 for i in range(n)]),
        ("unsigned", names.UIntArray, "uniform", [2**32 - 1 - i for i in range(n)]),
        ("whole", names.FloatArray, "uniform", [float(i * 3) for i in range(n)]),
        ("table", names.FloatArray, "uniform", [0.1 * (i % 4) for i in range(n)]),
        ("rough", names.FloatArray, "uniform", [i**0.5 for i in range(n)]),
        ("doubles", names.DoubleArray, "uniform", [0.1 * (i % 4) for i in range(n)]),
        ("halves", names.HalfArray, "uniform", [0.5 * (i % 4) for i in range(n)]),
        ("half3", names.Color3hArray, "uniform", [Gf.Vec3h(i, 0.5, -1) for i in range(n)]),
        ("double3", names.Vector3dArray, "uniform", [Gf.Vec3d(i, 0.1, -1) for i in range(n)]),
        ("st", names.TexCoord2fArray, "uniform", [Gf.Vec2f(i / 40, 0.1) for i in range(n)]),
        ("names", names.StringArray, "uniform", [f"tuft {i % 5} é\n" for i in range(n)]),
        ("tokens", names.TokenArray, "uniform", ["odd" if i % 2 else "even" for i in range(n)]),
        ("one", names.Float3, "constant", Gf.Vec3f(1, 2, 3)),
        ("other", names.Float3, "constant", Gf.Vec3f(1.5, 2, 3)),
        ("flag", names.Bool, "constant", True),
        ("single", names.Double, "constant", 0.1),
        ("path", names.Asset, "constant", Sdf.AssetPath("textures/a.png")),
    ]:
        api.CreatePrimvar(name, kind, interpolation).Set(value)
    picked = api.CreatePrimvar("picked", names.Color3fArray, "uniform")
    picked.Set([Gf.Vec3f(1, 0, 0), Gf.Vec3f(0, 0.5, 1)])
    picked.SetIndices(Vt.IntArray([i % 2 for i in range(n)]))


def transformed_stage(path):
    stage = Usd.Stage.CreateNew(str(path))
    UsdGeom.SetStageMetersPerUnit(stage, 1.0)
    UsdGeom.SetStageUpAxis(stage, UsdGeom.Tokens.z)
    top = UsdGeom.Xform.Define(stage, "/Top")
    top.AddTranslateOp().Set(Gf.Vec3d(1, 2, 3))
    top.AddRotateXYZOp().Set(Gf.Vec3f(10, 20, 30))
    top.AddScaleOp().Set(Gf.Vec3f(2, 2, 2))
    top.AddTranslateOp(opSuffix="pivot").Set(Gf.Vec3d(0, 5, 0))
    middle = UsdGeom.Xform.Define(stage, "/Top/Middle")
    middle.AddOrientOp().Set(Gf.Quatf(0.8, Gf.Vec3f(0, 0.6, 0)))
    middle.AddTransformOp().Set(Gf.Matrix4d(Gf.Rotation(Gf.Vec3d(1, 2, 3), 40), Gf.Vec3d(7, 8, 9)))
    middle.AddRotateZYXOp(opSuffix="b").Set(Gf.Vec3f(-5, 15, 25))
    pivot = top.GetOrderedXformOps()[3]
    middle.SetXformOpOrder([*middle.GetOrderedXformOps(), middle.AddTranslateOp(opSuffix="pivot")])
    middle.GetPrim().GetAttribute("xformOp:translate:pivot").Set(pivot.Get())
    middle.AddTranslateOp(opSuffix="pivot", isInverseOp=True)
    UsdGeom.Imageable(middle).CreatePurposeAttr("guide")
    curves_of_many_types(stage, "/Top/Middle/Curves", samples_only=False)
    curves_of_many_types(stage, "/Top/Moving", samples_only=True)
    reset = UsdGeom.Xform.Define(stage, "/Top/Reset")
    reset.AddRotateYOp().Set(90.0)
    reset.SetResetXformStack(True)
    curves_of_many_types(stage, "/Top/Reset/Curves", samples_only=False)
    stage.GetRootLayer().Save()
    return stage


def world_report(stage, predicate=Usd.PrimAllPrimsPredicate):
    """Points in centimetres, Y up, and primvars with indices resolved, as numbers."""
    report = {}
    cache = UsdGeom.XformCache(Usd.TimeCode(3.0))
    y_up = Gf.Matrix4d(1, 0, 0, 0, 0, 0, -1, 0, 0, 1, 0, 0, 0, 0, 0, 1)
    if UsdGeom.GetStageUpAxis(stage) != UsdGeom.Tokens.z:
        y_up = Gf.Matrix4d(1)
    centimetres = Gf.Matrix4d().SetScale(UsdGeom.GetStageMetersPerUnit(stage) * 100)
    for prim in stage.Traverse(predicate):
        if not prim.IsA(UsdGeom.BasisCurves):
            continue
        curves = UsdGeom.BasisCurves(prim)
        world = cache.GetLocalToWorldTransform(prim) * centimetres * y_up
        points = curves.GetPointsAttr().Get(3.0)
        primvars = {
            primvar.GetPrimvarName(): [
                float(v) if not isinstance(v, str) else v for v in flat_values(primvar)
            ]
            for primvar in UsdGeom.PrimvarsAPI(prim).GetAuthoredPrimvars()
        }
        report[str(prim.GetPath())] = {
            "purpose": UsdGeom.Imageable(prim).ComputePurpose(),
            "counts": list(curves.GetCurveVertexCountsAttr().Get()),
            "points": flat([tuple(world.Transform(p)) for p in points]) if points else None,
            "primvars": primvars,
        }
    return report


def flat_values(primvar):
    value = primvar.ComputeFlattened() if primvar.IsIndexed() else primvar.Get()
    return flat(value.path if isinstance(value, Sdf.AssetPath) else value)


def write(folder):
    folder = pathlib.Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    reports = {}
    for name in ("openusd.usdc", "openusd.usda"):
        path = folder / name
        path.unlink(missing_ok=True)
        reports[str(path)] = world_report(transformed_stage(path))
    print(json.dumps(reports))
    return True


def compose(folder):
    reports = {}
    for root in sorted(pathlib.Path(folder).glob("*/root.usd")):
        if root.parent.name.endswith("_crate"):
            continue
        stage = Usd.Stage.Open(str(root))
        predicate = Usd.TraverseInstanceProxies()
        reports[root.parent.name] = world_report(stage, predicate)
        for layer in sorted(root.parent.rglob("*.usd")):
            copy = root.parent.with_name(root.parent.name + "_crate") / layer.relative_to(root.parent)
            copy.parent.mkdir(parents=True, exist_ok=True)
            Sdf.Layer.FindOrOpen(str(layer)).Export(str(copy), args={"format": "usdc"})
    print(json.dumps(reports))
    return True


def main(arguments):
    match arguments:
        case ["report", *files] if files:
            return report(files)
        case ["equal", first, second]:
            return equal(first, second)
        case ["pairs", *files] if files and len(files) % 2 == 0:
            same = [equal(first, second) for first, second in zip(files[::2], files[1::2])]
            return report(files) and all(same)
        case ["control"]:
            return control()
        case ["write", folder]:
            return write(folder)
        case ["compose", folder]:
            return compose(folder)
    print(__doc__, file=sys.stderr)
    return False


if __name__ == "__main__":
    sys.exit(0 if main(sys.argv[1:]) else 1)
