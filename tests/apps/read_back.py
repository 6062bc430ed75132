#!/usr/bin/env python3
"""Runs a small scene, exports it, and reads the files back with other people's libraries.

The numbers must be those of frames/*.npy.

    read_back.py TAUT FORMAT      TAUT: the program; FORMAT: usd, obj, ply, vtk, gltf, pc2 or mdd

Ends with 77 (skipped) where the libraries are not there: `./taut test` fetches them into
build/test-python and build/test-node.
"""
import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
SKIPPED = 77


def use_test_python():
    """Starts again in the environment of tools/requirements-test.txt, unless this is it."""
    python = ROOT / "build/test-python/bin/python"
    if not python.exists():
        print("skipped: no build/test-python; ./taut test fetches it (tools/requirements-test.txt)")
        sys.exit(SKIPPED)
    if Path(sys.prefix).resolve() != python.parent.parent.resolve():
        os.execv(python, [str(python), *sys.argv])


SCENE = """title = "To be \\"read\\" back"
[time]
step = 4e-3
frames = 12
steps_per_frame = 2
[[cloth]]
name = "sheet one"
grid = { nodes = [7, 6], origin = [-0.3, -0.3, 0.31], u = [0.6, 0, 0], v = [0, 0.6, 0] }
density = 0.15
k_stretch = 500
[[cloth.pin]]
corners = ["u0v0"]
[[cloth]]
name = "triangle"
mesh = "triangle.ply"
density = 0.15
k_stretch = 100
velocity = [1, 0, 0.5]
[[solid]]
name = "ball"
shape = "sphere"
radius = 0.3
velocity = [0, 2, 0.25]
[[solid]]
shape = "box"
size = [1, 2, 0.5]
translation = [0, 0, -1]
[[solid]]
name = "wedge"
shape = "mesh"
mesh = "wedge.obj"
motion = "wedge.f32"
motion_rate = 50
translation = [5, 0, 0]
"""

WEDGE = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n"


def wedge_samples():
    """What wedge.f32 holds: 4 samples of 4 vertices, each moved somewhere else."""
    rest = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
    way = np.array([[0, 0, 0], [1, 0, 0], [0, -0.5, 0], [0, 0.5, 1]])
    return np.array([rest + 0.25 * k * way for k in range(4)], np.float32)


def check_wedge(points, frame):
    """Linear between samples, the last one held."""
    samples = wedge_samples().astype(float)
    place = min(frame * FRAME_INTERVAL * 50, 3)
    before = min(int(place), 2)
    step = samples[before + 1] - samples[before]
    expected = samples[before] + (place - before) * step + [5, 0, 0]
    near(points, expected, 1e-6, f"wedge, frame {frame}")


TRIANGLE = """ply
format ascii 1.0
element vertex 4
property float x
property float y
property float z
property float s
property float t
element face 2
property list uchar int vertex_indices
end_header
1 1 1 0 0
1.5 1 1 1 0
1.5 1.5 1 1 1
1 1.5 1 0 1
3 0 1 2
3 0 2 3
"""
FRAME_INTERVAL = 8e-3
TIMES = (0, 5, 12)  # the frames that are compared


class Run:
    """A finished run with its frames, read as docs/formats.md says."""

    def __init__(self, taut, folder):
        self.taut, self.folder = taut, Path(folder)
        (self.folder / "scene.toml").write_text(SCENE)
        (self.folder / "triangle.ply").write_text(TRIANGLE)
        (self.folder / "wedge.obj").write_text(WEDGE)
        wedge_samples().tofile(self.folder / "wedge.f32")
        self.call("run", "scene.toml", "--out", "result", "--quiet", "--no-picture")
        frames = self.folder / "result/frames"
        self.x = np.array([np.load(frames / f"{k:06}.npy") for k in range(13)])
        self.triangles = np.load(frames / "triangles.npy")
        self.uv = np.load(frames / "uv.npy")
        self.cloths = json.loads((frames / "cloths.json").read_text())

    def call(self, *arguments):
        done = subprocess.run([self.taut, *arguments], cwd=self.folder, capture_output=True,
                              text=True, timeout=120)
        assert done.returncode == 0, done.stderr

    def export(self, kind, *more):
        self.call("export", "result", "--format", kind, *more)
        out = self.folder / (more[more.index("--out") + 1] if "--out" in more else f"result/{kind}")
        left = [p.name for p in out.iterdir() if ".tmp" in p.name or p.name.startswith(".")]
        assert not left, left
        return out

    def cloth(self, number):
        """(points of all frames, triangles from 0, texture coordinates) of a cloth."""
        c = self.cloths[number]
        nodes = slice(c["first_node"], c["first_node"] + c["nodes"])
        first = c["first_triangle"]
        triangles = self.triangles[first:first + c["triangles"]] - c["first_node"]
        return self.x[:, nodes], triangles, self.uv[nodes]


def same(a, b, what):
    a, b = np.asarray(a), np.asarray(b)
    assert a.shape == b.shape, f"{what}: shape {a.shape}, expected {b.shape}"
    assert np.array_equal(a, b), f"{what}: differs by up to {np.abs(a - b).max()}"


def near(a, b, tolerance, what):
    a, b = np.asarray(a), np.asarray(b)
    assert a.shape == b.shape, f"{what}: shape {a.shape}, expected {b.shape}"
    assert np.abs(a - b).max() <= tolerance, f"{what}: differs by up to {np.abs(a - b).max()}"


def check_ball(points, frame):
    """A sphere of radius 0.3 that has flown for the frame's time."""
    centre = np.array([0, 2, 0.25]) * frame * FRAME_INTERVAL
    distances = np.linalg.norm(np.asarray(points, dtype=float) - centre, axis=1)
    near(distances, np.full(len(points), 0.3), 1e-6, f"ball, frame {frame}")


def check_box(points):
    same(np.asarray(points).min(axis=0), [-0.5, -1, -1.25], "box")
    same(np.asarray(points).max(axis=0), [0.5, 1, -0.75], "box")


def y_up(points):
    return np.stack([points[..., 0], points[..., 2], -points[..., 1]], axis=-1)


def usd_complaints(file):
    """What usdchecker complains about: it runs these validators."""
    from pxr import Usd, UsdValidation
    validators = UsdValidation.ValidationRegistry().GetOrLoadAllValidators()
    assert len(validators) >= 20, "the validators are not there"
    errors = UsdValidation.ValidationContext(validators).Validate(Usd.Stage.Open(str(file)))
    return [error.GetErrorAsString() for error in errors]


def check_usd(run):
    from pxr import Usd, UsdGeom
    file = run.export("usd") / "sequence.usda"
    assert usd_complaints(file) == [], usd_complaints(file)
    stage = Usd.Stage.Open(str(file))
    assert stage.GetDefaultPrim().GetName() == "World"
    assert UsdGeom.GetStageMetersPerUnit(stage) == 1 and UsdGeom.GetStageUpAxis(stage) == "Z"
    assert (stage.GetStartTimeCode(), stage.GetEndTimeCode()) == (0, 12)
    assert abs(stage.GetTimeCodesPerSecond() * FRAME_INTERVAL - 1) < 1e-12
    assert stage.GetRootLayer().documentation == 'To be "read" back'
    meshes = {p.GetName(): UsdGeom.Mesh(p) for p in stage.GetDefaultPrim().GetChildren()}
    assert list(meshes) == ["sheet_one", "triangle", "ball", "solid_1", "wedge"], list(meshes)
    for number, name in enumerate(["sheet_one", "triangle"]):
        points, triangles, uv = run.cloth(number)
        mesh = meshes[name]
        assert mesh.GetPointsAttr().GetNumTimeSamples() == 13
        st = UsdGeom.PrimvarsAPI(mesh).GetPrimvar("st")
        for attribute in (mesh.GetFaceVertexIndicesAttr(), mesh.GetFaceVertexCountsAttr(),
                          st.GetAttr()):
            assert attribute.GetNumTimeSamples() == 0, "written once"
        same(np.reshape(mesh.GetFaceVertexIndicesAttr().Get(), (-1, 3)), triangles, "triangles")
        same(mesh.GetFaceVertexCountsAttr().Get(), np.full(len(triangles), 3), "counts")
        same(st.Get(), uv, "st")
        assert st.GetInterpolation() == "vertex"
        assert mesh.GetDoubleSidedAttr().Get() and mesh.GetSubdivisionSchemeAttr().Get() == "none"
        for frame in TIMES:
            same(mesh.GetPointsAttr().Get(frame), points[frame], f"points, frame {frame}")
            extent = [points[frame].min(axis=0), points[frame].max(axis=0)]
            same(mesh.GetExtentAttr().Get(frame), extent, "extent")
    for frame in TIMES:
        check_ball(meshes["ball"].GetPointsAttr().Get(frame), frame)
        check_wedge(meshes["wedge"].GetPointsAttr().Get(frame), frame)
    assert meshes["solid_1"].GetPointsAttr().GetNumTimeSamples() == 0
    check_box(meshes["solid_1"].GetPointsAttr().Get())

    out = run.export("usd", "--scale", "100", "--up", "y", "--frames", "3:9:3",
                     "--out", "centimetres")
    file = out / "sequence.usda"
    assert usd_complaints(file) == [], usd_complaints(file)
    stage = Usd.Stage.Open(str(file))
    assert UsdGeom.GetStageMetersPerUnit(stage) == 0.01 and UsdGeom.GetStageUpAxis(stage) == "Y"
    points = UsdGeom.Mesh(stage.GetPrimAtPath("/World/sheet_one")).GetPointsAttr()
    assert points.GetTimeSamples() == [3, 6, 9], points.GetTimeSamples()
    near(points.Get(6), 100 * y_up(run.cloth(0)[0][6].astype(float)), 4e-6, "centimetres, Y up")
    check_usd_is_read_again(run)


def check_usd_is_read_again(run):
    """The cloth of the file in centimetres, Y up, starts where frame 3 was."""
    (run.folder / "again.toml").write_text(
        '[time]\nstep = 1e-3\nframes = 1\n[[cloth]]\n'
        'mesh = "result/../centimetres/sequence.usda"\nprim = "/World/sheet_one"\n'
        "density = 0.15\nk_stretch = 500\n")
    os.environ["TAUT_PYTHON"] = sys.executable
    run.call("run", "again.toml", "--out", "again", "--quiet", "--no-picture")
    points, triangles, uv = run.cloth(0)
    near(np.load(run.folder / "again/frames/000000.npy"), points[3], 1e-6, "points read again")
    same(np.load(run.folder / "again/frames/triangles.npy"), triangles, "triangles read again")
    same(np.load(run.folder / "again/frames/uv.npy"), uv, "texture coordinates read again")


def check_mesh_files(run, kind):
    import meshio
    import trimesh
    out = run.export(kind)
    names = sorted(p.name for p in out.iterdir())
    assert len(names) == 4 * 13 + 1 and f"solid_1.{kind}" in names, names
    for number, name in enumerate(["sheet_one", "triangle"]):
        points, triangles, uv = run.cloth(number)
        for frame in TIMES:
            file = out / f"{name}_{frame:06}.{kind}"
            mesh = meshio.read(file)
            same(mesh.points.astype(np.float32), points[frame], f"meshio: {file.name}")
            read_triangles = np.concatenate([block.data for block in mesh.cells])
            same(read_triangles, triangles, "meshio: triangles")
            other = trimesh.load(file, process=False, maintain_order=True)
            same(np.asarray(other.vertices, np.float32), points[frame], f"trimesh: {file.name}")
            same(other.faces, triangles, "trimesh: triangles")
            data = mesh.point_data
            read_uv = np.stack([data["s"], data["t"]], 1) if kind == "ply" else data["obj:vt"]
            same(read_uv.astype(np.float32), uv, "texture coordinates")
    for frame in TIMES:
        check_ball(meshio.read(out / f"ball_{frame:06}.{kind}").points, frame)
        check_wedge(meshio.read(out / f"wedge_{frame:06}.{kind}").points, frame)
    check_box(meshio.read(out / f"solid_1.{kind}").points)


def read_vtp(file):
    from vtkmodules.vtkIOXML import vtkXMLPolyDataReader
    reader = vtkXMLPolyDataReader()
    reader.SetFileName(str(file))
    reader.Update()
    assert reader.GetErrorCode() == 0
    return reader.GetOutput()


def check_vtk(run):
    import xml.etree.ElementTree as xml
    from vtkmodules.util.numpy_support import vtk_to_numpy
    out = run.export("vtk")
    entries = xml.parse(out / "sequence.pvd").getroot().findall("Collection/DataSet")
    assert len(entries) == 5 * 13
    for number, name in enumerate(["sheet_one", "triangle"]):
        points, triangles, uv = run.cloth(number)
        own = [e for e in entries if e.get("part") == str(number)]
        times = [float(e.get("timestep")) for e in own]
        near(times, np.arange(13) * FRAME_INTERVAL, 1e-12, "times")
        for frame in TIMES:
            data = read_vtp(out / own[frame].get("file"))
            same(vtk_to_numpy(data.GetPoints().GetData()), points[frame], f"{name}, frame {frame}")
            read_triangles = vtk_to_numpy(data.GetPolys().GetConnectivityArray())
            same(read_triangles.reshape(-1, 3), triangles, "triangles")
            same(vtk_to_numpy(data.GetPointData().GetTCoords()), uv, "texture coordinates")
            velocity = vtk_to_numpy(data.GetPointData().GetArray("velocity"))
            moved = (points[frame].astype(float) - points[frame - 1]) / FRAME_INTERVAL
            first = np.tile([0, 0, 0] if number == 0 else [1, 0, 0.5], (len(uv), 1))
            near(velocity, moved if frame else first, 1e-5, "velocity")
            strain = stretch(points[0], points[frame], triangles, number)
            near(vtk_to_numpy(data.GetPointData().GetArray("stretch")), strain, 2e-5, "stretch")
            assert data.GetPointData().GetScalars().GetName() == "stretch"
            contact = vtk_to_numpy(data.GetPointData().GetArray("contact"))
            first = run.cloths[number]["first_node"]
            recorded = np.load(run.folder / f"result/frames/contact_{frame:06}.npy")
            assert recorded.dtype == np.uint8, "docs/results.md"
            assert recorded.shape == (len(run.x[0]),), "docs/results.md"
            same(contact, recorded[first:first + len(contact)].astype(np.float32), "contact")
            distance = distance_from_ball(points[frame], frame)
            assert (distance[contact > 0] < 1e-4).all(), "what touches is near"
            touched.append((contact > 0).sum())
    assert max(touched) > 0, "no node touches the ball: the contact field is not tested"
    still = {e.get("file") for e in entries if e.get("part") == "3"}
    assert len(still) == 1, "what does not move has one file"
    check_box(vtk_to_numpy(read_vtp(out / "solid_1.vtp").GetPoints().GetData()))
    check_vtk_of_an_older_result(run)


def check_vtk_of_an_older_result(run):
    """Without recorded contact the field is made from distances."""
    from vtkmodules.util.numpy_support import vtk_to_numpy
    for file in (run.folder / "result/frames").glob("contact_*.npy"):
        file.unlink()
    out = run.export("vtk", "--out", "older")
    near_ball = []
    for frame in TIMES:
        data = read_vtp(out / f"sheet_one_{frame:06}.vtp").GetPointData()
        contact = vtk_to_numpy(data.GetArray("contact"))
        expected = distance_from_ball(run.cloth(0)[0][frame], frame) <= 1.6e-4
        same(contact, expected.astype(np.float32), "contact from distances")
        near_ball.append(contact.sum())
    assert max(near_ball) > 0


def distance_from_ball(points, frame):
    return np.linalg.norm(points - np.array([0, 2, 0.25]) * frame * FRAME_INTERVAL, axis=1) - 0.3


touched = []


def stretch(rest, x, triangles, number):
    """The largest strain of the edges at each node: a grid's rows and columns, a mesh's edges."""
    if number == 0:
        nodes = np.arange(42).reshape(6, 7)
        edges = np.concatenate([np.stack([nodes[:, :-1].ravel(), nodes[:, 1:].ravel()], 1),
                                np.stack([nodes[:-1].ravel(), nodes[1:].ravel()], 1)])
    else:
        edges = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    length = lambda p: np.linalg.norm(p[edges[:, 0]].astype(float) - p[edges[:, 1]], axis=1)
    strain = length(x) / length(rest) - 1
    result = np.full(len(x), -np.inf)
    for side in (0, 1):
        np.maximum.at(result, edges[:, side], strain)
    return result


def validate_gltf(file):
    """The Khronos validator's report; None where it is not there."""
    validator = ROOT / "build/test-node/node_modules/gltf-validator"
    if not validator.exists():
        print("not validated: no build/test-node; ./taut test fetches gltf-validator with npm")
        return None
    script = ("const v = require(process.argv[1]), fs = require('fs');"
              "v.validateBytes(new Uint8Array(fs.readFileSync(process.argv[2])), {maxIssues: 20})"
              ".then(r => console.log(JSON.stringify(r)));")
    done = subprocess.run(["node", "-e", script, str(validator), str(file)], capture_output=True,
                          text=True, check=True)
    return json.loads(done.stdout)


def read_glb(file):
    data = file.read_bytes()
    length = int.from_bytes(data[12:16], "little")
    gltf, binary = json.loads(data[20:20 + length]), data[20 + length + 8:]

    def accessor(k):
        a, view = gltf["accessors"][k], gltf["bufferViews"][gltf["accessors"][k]["bufferView"]]
        width = {"SCALAR": 1, "VEC2": 2, "VEC3": 3}[a["type"]]
        kind = {5126: "<f4", 5125: "<u4"}[a["componentType"]]
        values = np.frombuffer(binary, kind, a["count"] * width, view["byteOffset"])
        return values.reshape(-1, width)

    return gltf, accessor


def check_gltf(run):
    import trimesh
    out = run.export("gltf")
    file = out / "sequence.glb"
    report = validate_gltf(file)
    if report:
        issues = report["issues"]
        clean = issues["numErrors"] == 0 and issues["numWarnings"] == 0
        assert clean, json.dumps(issues, indent=1)
        assert report["info"]["hasMorphTargets"] and report["info"]["animationCount"] == 1
    gltf, accessor = read_glb(file)
    names = [node["name"] for node in gltf["nodes"]]
    assert names == ["sheet_one", "triangle", "ball", "solid_1", "wedge"], names
    animation = gltf["animations"][0]
    times = accessor(animation["samplers"][0]["input"])[:, 0]
    near(times, np.arange(13) * FRAME_INTERVAL, 1e-7, "times")
    for number in (0, 1, 2):
        primitive = gltf["meshes"][number]["primitives"][0]
        base = accessor(primitive["attributes"]["POSITION"])
        targets = np.array([accessor(t["POSITION"]) for t in primitive["targets"]])
        weights = accessor(animation["samplers"][number]["output"])
        weights = weights.reshape(len(times), len(targets))
        for frame in TIMES:
            shown = base + np.tensordot(weights[frame], targets, 1)
            if number == 2:
                check_ball(np.stack([shown[:, 0], -shown[:, 2], shown[:, 1]], 1), frame)
            else:
                near(shown, y_up(run.cloth(number)[0][frame]), 2e-7, f"points, frame {frame}")
    points, triangles, uv = run.cloth(0)
    primitive = gltf["meshes"][0]["primitives"][0]
    same(accessor(primitive["indices"]).reshape(-1, 3), triangles, "triangles")
    texture = accessor(primitive["attributes"]["TEXCOORD_0"])
    near(texture, np.stack([uv[:, 0], 1 - uv[:, 1]], 1), 1e-7, "texture")
    assert "targets" not in gltf["meshes"][3]["primitives"][0]
    scene = trimesh.load(file, process=False)
    same(np.asarray(scene.geometry["sheet_one"].vertices, np.float32), y_up(points[0]), "trimesh")
    same(scene.geometry["sheet_one"].faces, triangles, "trimesh: triangles")
    # One frame: a still mesh.
    still = run.export("gltf", "--frames", "7", "--out", "still") / "sequence.glb"
    report = validate_gltf(still)
    assert not report or report["issues"]["numErrors"] == 0, report
    gltf, accessor = read_glb(still)
    assert "animations" not in gltf
    same(accessor(0), y_up(points[7]), "still")


def read_pc2(file):
    data = file.read_bytes()
    assert data[:12] == b"POINTCACHE2\0"
    version, points = np.frombuffer(data, "<i4", 2, 12)
    start, rate = np.frombuffer(data, "<f4", 2, 20)
    samples = np.frombuffer(data, "<i4", 1, 28)[0]
    assert (version, start, rate) == (1, 0, 1)
    return np.frombuffer(data, "<f4", -1, 32).reshape(samples, points, 3)


def read_mdd(file):
    data = file.read_bytes()
    frames, points = np.frombuffer(data, ">i4", 2)
    near(np.frombuffer(data, ">f4", frames, 8), np.arange(frames) * FRAME_INTERVAL, 1e-7, "times")
    return np.frombuffer(data, ">f4", -1, 8 + 4 * frames).reshape(frames, points, 3)


def check_cache(run, kind):
    """No library of Python's reads point caches: NumPy, from the formats' descriptions."""
    import meshio
    read = {"pc2": read_pc2, "mdd": read_mdd}[kind]
    out = run.export(kind)
    moving = ("sheet_one", "triangle", "ball", "wedge")
    expected = [f"{name}.{ending}" for name in moving for ending in ("obj", kind)]
    assert sorted(p.name for p in out.iterdir()) == sorted(expected + ["solid_1.obj"])
    for number, name in enumerate(["sheet_one", "triangle"]):
        cache = read(out / f"{name}.{kind}").astype(np.float32)
        same(cache, run.cloth(number)[0], name)
        mesh = meshio.read(out / f"{name}.obj")
        same(mesh.points.astype(np.float32), cache[0], "the mesh is the first sample")
    ball, wedge = (read(out / f"{name}.{kind}") for name in ("ball", "wedge"))
    for frame in TIMES:
        check_ball(ball[frame], frame)
        check_wedge(wedge[frame], frame)


def main():
    taut, kind = sys.argv[1:]
    checks = {"usd": check_usd, "vtk": check_vtk, "gltf": check_gltf}
    with tempfile.TemporaryDirectory() as folder:
        run = Run(taut, folder)
        if kind in checks:
            checks[kind](run)
        elif kind in ("obj", "ply"):
            check_mesh_files(run, kind)
        else:
            check_cache(run, kind)
    print(f"{kind}: the numbers are the same")


if __name__ == "__main__":
    use_test_python()
    import numpy as np
    main()
