"""The shroud itself: that of the program, with its settings, progress, report and network."""

import _thread
import inspect
import json
import multiprocessing
import os
import pickle
import signal
import threading

import numpy as np
import pytest
import trimesh

import shrouds
from shrouds import _native

SETTINGS = [
    {},
    {"preset": "fast"},
    {"preset": "exact"},
    {"energy": "bending+0.3*variation", "tolerance": 1e-3},
    {"surface": "dual", "triangles": "fixed", "faces": "join"},
    {"border": "open", "start": "random:7", "max_iterations": 3},
    {"volume": "keep"},
    {"crease": 5.7},
    {"energy": "curvature(chord)", "solver": "sweeps", "max_iterations": 5},
]


@pytest.mark.parametrize("settings", SETTINGS, ids=lambda s: " ".join(map(str, s.values())))
def test_the_mesh_and_the_report_are_those_of_the_program(program, body, tmp_path, settings):
    np.save(tmp_path / "body.npy", body)
    options = [f"--{name.replace('_', '-')}={value}" for name, value in settings.items()]
    printed = program(
        "mesh", tmp_path / "body.npy", "-o", tmp_path / "body.ply", "--json",
        "--spacing", "0.5,0.75,1.25", *options,
    )  # fmt: skip
    made = shrouds.shroud(body, spacing=(0.5, 0.75, 1.25), **settings)
    file = trimesh.load(tmp_path / "body.ply", process=False)
    assert made.vertices.dtype == np.float32
    assert np.array_equal(file.vertices.astype(np.float32), made.vertices)
    assert np.array_equal(file.faces, made.faces)
    made.save(tmp_path / "ours.ply")
    ours, theirs = ((tmp_path / name).read_bytes() for name in ("ours.ply", "body.ply"))
    assert ours.replace(b"SPACE=index UNIT=unknown", b"") == theirs.replace(
        b"SPACE=index UNIT=unknown", b""
    )
    ours, theirs = made.report, json.loads(printed)
    assert ours.keys() == theirs.keys()
    for part in ("topology", "solver", "checks"):
        assert ours[part] == theirs[part], part
    theirs["input"]["file"] = None
    assert ours["input"] == theirs["input"]
    assert {**theirs["settings"], "frame": 0, "rough": 0} == {
        **{name: None for name in theirs["settings"]}, **ours["settings"], "frame": 0, "rough": 0,
    }  # fmt: skip
    assert ours["geometry"] == pytest.approx(theirs["geometry"], rel=1e-6)
    assert ours["times"].keys() == theirs["times"].keys()


def test_every_setting_of_the_library_is_an_argument():
    arguments = inspect.signature(shrouds.shroud).parameters
    names = [name for name in arguments if name in _native.setting_names()]
    assert names == _native.setting_names()
    assert all(f"    {name}\n" in shrouds.shroud.__doc__ for name in names)


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"energy": "bnding"}, "bending"),
        ({"preset": "fats"}, 'preset is "fats", but must be fast, default, exact'),
        ({"tolerance": 2}, "tolerance is 2, but must be above 0 and below 1"),
        ({"preset": "fast", "tolerance": 1e-3}, "exact with a tolerance"),
        ({"max_iterations": -1}, "whole number"),
        ({"volume": "keep", "solver": "sweeps"}, "free for the sweeps"),
        ({"start": "random"}, "random:SEED"),
        ({"margin": 0.5}, "between 1e-6 and 0.1"),
    ],
)
def test_settings_that_cannot_be(body, settings, message):
    with pytest.raises(ValueError, match=message):
        shrouds.shroud(body, **settings)


def test_trimesh_says_watertight(body):
    made = shrouds.shroud(body)
    mesh = made.to_trimesh()
    assert mesh.is_watertight and mesh.is_winding_consistent and mesh.volume > 0
    assert mesh.euler_number == 2
    assert np.array_equal(mesh.faces, made.faces)
    report = made.report
    assert report["checks"]["ok"] and report["checks"]["wrong_side"] == 0
    assert report["input"]["inside"] == body.sum()


def test_the_same_bits_on_any_number_of_threads(gyroid):
    one, three = (shrouds.shroud(gyroid[:64], threads=n) for n in (1, 3))
    assert np.array_equal(one.vertices, three.vertices) and np.array_equal(one.faces, three.faces)


def test_nothing_inside_gives_nothing():
    made = shrouds.shroud(np.zeros((4, 5, 6), bool))
    assert made.vertices.shape == (0, 3) and made.faces.shape == (0, 3)
    assert made.report["solver"]["status"] == "empty"
    assert [len(family) for family in made.network] == [0, 0, 0]
    assert all(len(family.segments()) == 0 for family in made.network)


def test_progress_is_told_in_order(gyroid):
    told = []
    made = shrouds.shroud(gyroid, progress=told.append)
    shares = [now.share for now in told]
    assert shares == sorted(shares) and 0 < shares[0] and shares[-1] == pytest.approx(1.0)
    assert all(isinstance(now, shrouds.Progress) for now in told)
    assert np.array_equal(made.vertices, shrouds.shroud(gyroid).vertices)


def test_a_callback_stops_the_work(gyroid):
    told = []

    def stop(now):
        told.append(now)
        return len(told) < 3

    made = shrouds.shroud(gyroid, preset="exact", progress=stop)
    assert len(told) == 3 and made.report["solver"]["status"] == "cancelled"
    assert made.report["checks"]["ok"]


def test_an_exception_in_a_callback_goes_through(gyroid):
    def fail(_):
        raise LookupError("here")

    with pytest.raises(LookupError, match="here"):
        shrouds.shroud(gyroid, progress=fail)


@pytest.mark.parametrize("work", ["shroud", "sweeps", "check"])
def test_ctrl_c_and_other_threads(gyroid, work):
    """Only another thread of Python can interrupt, so this holds the lock's release, too."""
    # A job in the background ignores interrupts from its birth.
    signal.signal(signal.SIGINT, signal.default_int_handler)
    made = shrouds.shroud(gyroid, preset="fast")
    timer = threading.Timer(0.2, _thread.interrupt_main)
    with pytest.raises(KeyboardInterrupt):
        timer.start()
        # Some minutes, unless it is interrupted.
        for _ in range(1000):
            if work == "check":
                shrouds.check(made, gyroid)
            else:
                solver = {"shroud": "newton", "sweeps": "sweeps"}[work]
                shrouds.shroud(gyroid, solver=solver, tolerance=1e-9, max_iterations=100_000)
    timer.join()


def test_the_network_is_that_of_the_theorem(body, program, tmp_path):
    made = shrouds.shroud(body)
    counts = np.zeros(len(made.vertices), int)
    for axis, family in enumerate(made.network):
        assert family.closed.all() and len(family) == sum(1 for _ in family)
        for curve in family:
            plane = made.vertices[curve, axis]
            assert np.ptp(plane) == 0 and plane[0] == np.rint(plane[0])
            counts[curve] += 1
        segments = family.segments()
        assert len(segments) == len(family.vertices)
        first = next(iter(family))
        assert np.array_equal(segments[: len(first)], np.column_stack([first, np.roll(first, -1)]))
    assert (counts == 2).all()
    np.save(tmp_path / "body.npy", body)
    report = json.loads(
        program("network", tmp_path / "body.npy", "-o", tmp_path / "lines.obj", "--json")
    )
    assert [family["curves"] for family in report["families"]] == list(map(len, made.network))


def test_open_curves_have_ends(body):
    made = shrouds.shroud(body[:20], border="open")
    family = made.network[0]
    assert not family.closed.all()
    steps = np.diff(family.starts)
    assert len(family.segments()) == (steps - ~family.closed).sum()


def test_a_pickle_keeps_all_but_the_voxels(body):
    made = shrouds.shroud(body)
    again = pickle.loads(pickle.dumps(made))
    assert np.array_equal(again.vertices, made.vertices) and again.report == made.report
    with pytest.raises(RuntimeError, match="left its voxels behind"):
        _ = again.network
    _ = made.network
    assert len(pickle.loads(pickle.dumps(made)).network) == 3


def test_pyvista_has_it_all(body):
    pyvista = pytest.importorskip("pyvista")
    made = shrouds.shroud(body)
    data = made.to_pyvista()
    assert isinstance(data, pyvista.PolyData) and data.is_manifold and data.n_open_edges == 0
    assert np.array_equal(data.regular_faces, made.faces)
    assert np.array_equal(data.points, made.vertices)
    assert data.points.dtype == np.float32
    outward = (data.face_normals * data.point_normals[made.faces[:, 0]]).sum(axis=1)
    assert (outward > 0).mean() > 0.99
    assert "delta" in data.point_data
    assert "delta" not in shrouds.shroud(body, surface="dual").to_pyvista().point_data


def test_napari_gets_z_y_x(body):
    (vertices, faces), options, kind = shrouds.shroud(body).to_napari("ball")
    assert kind == "surface" and options == {"name": "ball"}
    inside = np.argwhere(body)
    assert (vertices.min(0) > inside.min(0) - 1).all() and (vertices.max(0) < inside.max(0) + 1).all()
    assert faces.max() == len(vertices) - 1


@pytest.mark.parametrize("ending", ["ply", "stl", "obj", "glb", "vtp", "3mf"])
def test_all_formats_are_written(body, tmp_path, ending):
    made = shrouds.shroud(body)
    made.save(tmp_path / f"body.{ending}")
    if ending == "3mf":
        pytest.importorskip("lxml")
    if ending != "vtp":
        mesh = trimesh.load(tmp_path / f"body.{ending}", force="mesh")
        assert len(mesh.faces) == len(made.faces)


def test_files_that_cannot_be(body, tmp_path):
    made = shrouds.shroud(body)
    with pytest.raises(ValueError, match="not a known kind of mesh"):
        made.save(tmp_path / "body.mesh")
    with pytest.raises(OSError, match="cannot"):
        made.save("/proc/nowhere/body.ply")
    with pytest.raises(ValueError, match="give delta"):
        made.save(tmp_path / "body.ply", attributes=["curvature"])
    made.save(tmp_path / "body.ply", attributes=["delta"])
    assert b"property float delta" in (tmp_path / "body.ply").read_bytes()[:600]
    dual = shrouds.shroud(body, surface="dual")
    with pytest.raises(ValueError, match="primal"):
        dual.save(tmp_path / "dual.ply", attributes=["delta"])


def fork_and_shroud(mask):
    return len(shrouds.shroud(mask).vertices)


@pytest.mark.skipif(not hasattr(os, "fork"), reason="there are no forks")
@pytest.mark.filterwarnings("ignore:.*fork.*:DeprecationWarning")
def test_processes_that_fork_have_threads_of_their_own(body):
    expected = fork_and_shroud(body)
    with multiprocessing.get_context("fork").Pool(2) as pool:
        assert pool.map_async(fork_and_shroud, [body, body]).get(120) == [expected] * 2


def test_rough_places_are_those_of_the_program(program, body, tmp_path):
    rough = np.zeros(body.shape, bool)
    rough[:, :, 30:45] = True
    np.save(tmp_path / "body.npy", body)
    np.save(tmp_path / "rough.npy", rough)
    program(
        "mesh", tmp_path / "body.npy", "--rough", tmp_path / "rough.npy", "-o", tmp_path / "a.ply"
    )
    made = shrouds.shroud(body, rough=rough)
    vertices, faces = shrouds.read_mesh(tmp_path / "a.ply")
    assert np.array_equal(vertices.astype(np.float32), made.vertices)
    assert np.array_equal(faces, made.faces)
    assert not np.array_equal(shrouds.shroud(body).delta, made.delta)
    turned = shrouds.shroud(body.T, axes="xyz", rough=rough.T)
    assert np.array_equal(turned.vertices, made.vertices)
    with pytest.raises(ValueError, match="shape"):
        shrouds.shroud(body, rough=rough[1:])


def test_strict_converges_or_says_so(body):
    assert shrouds.shroud(body, strict=True).status == "converged"
    with pytest.raises(shrouds.NotConverged, match="max_iterations") as failure:
        shrouds.shroud(body, strict=True, max_iterations=1)
    assert len(failure.value.shroud.vertices)
    with pytest.raises(ValueError, match="before convergence"):
        shrouds.shroud(body, strict=True, preset="fast")


def test_a_parameter_goes_into_the_energy(body):
    one = shrouds.shroud(body, energy="curvature", parameter="foley", preset="fast")
    other = shrouds.shroud(body, energy="curvature(foley)", preset="fast")
    assert np.array_equal(one.delta, other.delta)
    with pytest.raises(ValueError, match="cannot go into"):
        shrouds.shroud(body, parameter="foley")
    with pytest.raises(ValueError, match="centripetal"):
        shrouds.shroud(body, energy="curvature", parameter="chrod")
