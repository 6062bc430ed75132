#include "taut/io/usd_script.h"

namespace taut {

// Exit code 3: the message on standard error is for the user. 4: there is no pxr.
const char* const usd_script = R"python(
import sys

sys.path = [folder for folder in sys.path if folder]  # no modules from the folder that one happens to stand in

import math


def refuse(message):
    print(message, file=sys.stderr)
    sys.exit(3)


try:
    from pxr import Usd, UsdGeom
except ImportError as error:
    print(error, file=sys.stderr)
    sys.exit(4)


def meshes_of(stage):
    return [prim for prim in Usd.PrimRange(stage.GetPseudoRoot(), Usd.TraverseInstanceProxies()) if prim.IsA(UsdGeom.Mesh)]


def chosen_mesh(stage, wanted):
    if wanted:
        prim = stage.GetPrimAtPath(wanted)
        if not prim:
            refuse("has no prim %s; its meshes are: %s" % (wanted, listed(meshes_of(stage))))
        inside = [p for p in Usd.PrimRange(prim, Usd.TraverseInstanceProxies()) if p.IsA(UsdGeom.Mesh)]
        if len(inside) == 1:
            return inside[0]
        refuse("the prim %s holds %d meshes, one was expected: %s" % (wanted, len(inside), listed(inside)))
    found = meshes_of(stage)
    if len(found) == 1:
        return found[0]
    if not found:
        refuse("holds no mesh; curves, subdivision cages without faces and other shapes are not read")
    refuse('holds %d meshes; say which with prim = "%s", or: %s' % (len(found), found[0].GetPath(), listed(found[1:])))


def listed(prims):
    names = [str(prim.GetPath()) for prim in prims[:20]]
    return ", ".join(names) + (" and %d more" % (len(prims) - 20) if len(prims) > 20 else "") or "none"


def texture_coordinates(prim):
    """A primvar of pairs as (values, how), preferring the usual name."""
    found = {}
    for primvar in UsdGeom.PrimvarsAPI(prim).FindPrimvarsWithInheritance():
        if str(primvar.GetTypeName()) in ("texCoord2f[]", "texCoord2d[]", "texCoord2h[]", "float2[]"):
            values = primvar.ComputeFlattened(Usd.TimeCode.EarliestTime())
            if values:
                found[primvar.GetPrimvarName()] = (values, primvar.GetInterpolation())
    for name in ("st", "UVMap", "uv", "st0", *sorted(found)):
        if name in found:
            return found[name]
    return None, None


def main():
    path, wanted = sys.argv[1:3]
    try:
        stage = Usd.Stage.Open(path)
    except Exception as error:
        refuse("cannot be opened as USD: " + str(error).strip().splitlines()[-1])
    prim = chosen_mesh(stage, wanted)
    name = str(prim.GetPath())
    mesh, time = UsdGeom.Mesh(prim), Usd.TimeCode.EarliestTime()
    attributes = mesh.GetPointsAttr(), mesh.GetFaceVertexCountsAttr(), mesh.GetFaceVertexIndicesAttr()
    points, counts, indices = (attribute.Get(time) for attribute in attributes)
    if not points or not counts or not indices:
        refuse("the mesh %s has no points or no faces" % name)
    if min(counts) < 3 or sum(counts) != len(indices) or min(indices) < 0 or max(indices) >= len(points):
        refuse("the faces of %s do not fit its %d points" % (name, len(points)))
    if not all(math.isfinite(value) for point in points for value in point):
        refuse("the mesh %s has a point that is not finite" % name)

    unit = UsdGeom.GetStageMetersPerUnit(stage)
    y_up = UsdGeom.GetStageUpAxis(stage) == UsdGeom.Tokens.y
    place = UsdGeom.XformCache(time).GetLocalToWorldTransform(prim)
    mirrored = (place.GetDeterminant() < 0) != (mesh.GetOrientationAttr().Get(time) == UsdGeom.Tokens.leftHanded)
    out = ["# " + name]
    for point in points:
        x, y, z = (unit * value for value in place.Transform(tuple(point)))
        out.append("v %.17g %.17g %.17g" % ((x, -z, y) if y_up else (x, y, z)))
    values, how = texture_coordinates(prim)
    wanted_count = {"vertex": len(points), "varying": len(points), "faceVarying": len(indices)}.get(how)
    if values is None or len(values) != wanted_count:
        how = None
    else:
        out.extend("vt %.9g %.9g" % (pair[0], pair[1]) for pair in values)
    at = 0
    for count in counts:
        corners = range(at, at + count)
        at += count
        if mirrored:
            corners = reversed(corners)
        if how is None:
            out.append("f " + " ".join(str(indices[c] + 1) for c in corners))
        elif how == "faceVarying":
            out.append("f " + " ".join("%d/%d" % (indices[c] + 1, c + 1) for c in corners))
        else:
            out.append("f " + " ".join("%d/%d" % (indices[c] + 1, indices[c] + 1) for c in corners))
    sys.stdout.write("\n".join(out) + "\n")


main()
)python";

}  // namespace taut
