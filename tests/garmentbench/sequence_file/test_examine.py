"""`check_sequence` says everything that is wrong, where, and what to do."""

import shutil
from dataclasses import replace

import h5py
import numpy as np
import pytest

from garmentbench.errors import UserError
from garmentbench.evaluation.toy import tiny_sequence
from garmentbench.sequence_file.examine import check_sequence
from garmentbench.sequence_file.read_write import load, save


@pytest.fixture(scope="module")
def good(tmp_path_factory):
    path = tmp_path_factory.mktemp("good") / "tiny.h5"
    save(tiny_sequence(20), path)
    return path


@pytest.fixture
def edit(good, tmp_path):
    """Make a copy of the good file, with arrays replaced (or deleted, by None)."""

    def edit(**arrays):
        path = shutil.copy(good, tmp_path / "edited.h5")
        with h5py.File(path, "r+") as file:
            for name, change in arrays.items():
                name = name.replace("__", "/")
                old = file[name][()] if name in file else None
                if name in file:
                    del file[name]
                if change is not None:
                    file[name] = change(old)
        return path

    return edit


def put(index, value):
    def change(array):
        array[index] = value
        return array

    return change


def test_a_good_file_has_no_problems(good):
    assert check_sequence(good) == []


BAD = {
    "NaN": ({"garment__frames": put((7, 12, 1), np.nan)}, "garment/frames: NaN or infinite at frame 7, vertex 12 (1"),
    "infinite body": ({"body__frames": put((3, 0), np.inf)}, "body/frames: NaN or infinite at frame 3, vertex 0 (3"),
    "NaN in UV": ({"garment__uv": put(5, np.nan)}, "garment/uv: NaN or infinite at vertex 5"),
    "face out of range": ({"garment__faces": put((4, 2), 105)}, "garment/faces: row 4 names vertex 105, there are 105"),
    "negative index": ({"body__faces": put((0, 0), -1)}, "body/faces: row 0 names vertex -1"),
    "seam out of range": ({"garment__seams": put((1, 0), 999)}, "garment/seams: row 1 names vertex 999"),
    "frame counts": ({"body__frames": lambda a: a[:-2]}, "body/frames: 18 frames, but garment/frames has 20"),
    "vertex counts": ({"garment__uv": lambda a: a[:-2]}, "garment/uv: 103 garment vertices, but garment/rest has 105"),
    "no UV": ({"garment__uv": None}, "garment/uv: missing: the mesh has no UV coordinates"),
    "empty UV": ({"garment__uv": lambda a: 0 * a}, "garment/uv: the mesh has no UV map"),
    "UV outside": ({"garment__uv": put((0, 0), 1.5)}, "garment/uv: vertex 0 is at [1.5, 0.0], wanted [0, 1]"),
    "centimetres": (
        {"garment__rest": lambda a: 100 * a, "garment__frames": lambda a: 100 * a},
        "garment/rest: measures 89.5 m across, wanted 0.05 to 8 m: in centimetres?; multiply all positions by 0.01",
    ),
    "millimetres": ({"body__rest": lambda a: 1000 * a}, "in millimetres?; multiply all positions by 0.001"),
    "frames in centimetres": ({"garment__frames": lambda a: 100 * a}, "m long in frame 0"),
    "hash": ({"garment__frames": put((7, 12, 1), 0.5)}, "attribute content_hash: does not fit the arrays"),
    "another type": (
        {"garment__frames": lambda a: a.astype(np.float64)},
        "garment/frames: float64 of shape (20, 105, 3)",
    ),
    "another shape": ({"garment__faces": lambda a: a[:, :2]}, "garment/faces: int32 of shape (168, 2)"),
    "scalar": ({"garment__frames": lambda a: 3.0}, "garment/frames: float64 of shape ()"),
    "text": (
        {"garment__frames": lambda a: "frames"},
        "garment/frames: can't be read (garment/frames is not an array of numbers",
    ),
    "no frames": ({"garment__frames": lambda a: a[:0], "body__frames": lambda a: a[:0]}, "garment/frames: empty"),
    "runs of another length": (
        {"garment__runs": lambda _: np.zeros((2, 19, 105, 3), np.float32)},
        "garment/runs: 19 frames, but garment/frames has 20",
    ),
    "runs of another garment": (
        {"garment__runs": lambda _: np.zeros((2, 20, 99, 3), np.float32)},
        "garment/runs: 99 garment vertices, but garment/rest has 105",
    ),
    "one run without its axis": (
        {"garment__runs": lambda _: np.zeros((20, 105, 3), np.float32)},
        "garment/runs: float32 of shape (20, 105, 3), wanted float32 of shape (M, T, V, 3)",
    ),
    "no runs in it": ({"garment__runs": lambda _: np.zeros((0, 20, 105, 3), np.float32)}, "garment/runs: empty"),
    "a lost body": ({"body__frames": None, "body__rest": None}, "body/rest: missing"),
}


@pytest.mark.parametrize("case", BAD)
def test_each_error_is_told_and_refused(edit, case):
    arrays, says = BAD[case]
    path = edit(**arrays)
    problems = check_sequence(path)
    told = [p for p in problems if says in str(p)]
    assert len(told) == 1 and not told[0].warning and told[0].do, [str(p) for p in problems]
    with pytest.raises(UserError):
        load(path)


def test_everything_is_told_in_one_go(edit):
    path = edit(
        garment__frames=put((7, 12), np.nan),
        body__frames=lambda a: a[:-2],
        garment__uv=None,
        garment__faces=put((4, 2), 105),
        body__rest=lambda a: 100 * a,
    )
    told = "\n".join(map(str, check_sequence(path)))
    for part in ("frame 7, vertex 12", "18 frames", "no UV", "names vertex 105", "in centimetres?"):
        assert part in told
    with pytest.raises(UserError, match=r"\(and \d+ more, see garmentbench check"):
        load(path)


def test_warnings_do_not_forbid_use(tmp_path):
    sequence = tiny_sequence(20)
    garment = sequence.template.garment
    garment.faces[5] = garment.faces[4]  # an edge with three faces
    garment.faces[9, 2] = garment.faces[9, 1]  # no area
    garment.rest[garment.seams[2, 0], 2] += 0.01
    sequence.garment[11, garment.seams[3, 1]] += 0.02
    save(sequence, tmp_path / "a.h5")
    problems = check_sequence(tmp_path / "a.h5")
    assert all(p.warning for p in problems)
    told = "\n".join(map(str, problems))
    assert "1 degenerate faces (no area), the first is face 9" in told
    assert "not manifold" in told
    assert "pair 2 is 10 mm apart in garment/rest (1 such in all)" in told
    assert "apart in garment/frames" in told
    load(tmp_path / "a.h5")


def test_a_garment_that_begins_inside_is_warned_of(tmp_path):
    sequence = tiny_sequence(20)
    body = sequence.body.mean(axis=1, keepdims=True)
    sequence.garment[:] = body + 0.8 * (sequence.garment - body)
    save(sequence, tmp_path / "a.h5")
    (problem,) = check_sequence(tmp_path / "a.h5")
    assert problem.where == "frame 0" and problem.warning and "100.0 % of the garment's vertices" in problem.what
    with pytest.warns(UserWarning, match="frame 0"):
        load(tmp_path / "a.h5")


def test_cloth_that_passes_through_itself_is_warned_of(tmp_path):
    sequence = tiny_sequence(10)
    garment = sequence.garment.copy()
    garment[4:, :, 1] *= np.linspace(1, -1, garment.shape[1], dtype=np.float32)  # the tube's upper half inside out
    save(replace(sequence, garment=garment), tmp_path / "twisted.h5")
    told = [str(p) for p in check_sequence(tmp_path / "twisted.h5") if "cross others" in p.what]
    assert len(told) == 1 and "25) in frame 6;" in told[0] and "self_contact" in told[0]


def test_a_run_that_broke_is_warned_of(tmp_path):
    sequence = tiny_sequence(20, runs=3)
    sequence.runs[1, 7:, 4] = np.inf
    save(sequence, tmp_path / "a.h5")
    (problem,) = check_sequence(tmp_path / "a.h5")
    assert problem.warning and "further run 2 is not finite from frame 7 on" in str(problem)
    assert len(load(tmp_path / "a.h5").runs) == 3


def test_an_open_body_is_warned_of(tmp_path):
    sequence = tiny_sequence(20)
    body = sequence.template.body
    object.__setattr__(body, "faces", body.faces[1:])
    save(sequence, tmp_path / "a.h5")
    (problem,) = check_sequence(tmp_path / "a.h5")
    assert problem.warning and problem.what.startswith("3 edges don't have two faces")


def test_attributes_are_checked(good, tmp_path):
    path = shutil.copy(good, tmp_path / "a.h5")
    with h5py.File(path, "r+") as file:
        file.attrs.update(fps=-1.0, info=np.bytes_("{"), units=np.bytes_("inches"))
        del file["garment"].attrs["name"]
        file["body"].attrs["kind"] = np.bytes_("horse")
    told = "\n".join(map(str, check_sequence(path)))
    for part in (
        "attribute fps: -1",
        "attribute info: no JSON",
        "attribute units",
        "garment attribute name",
        "'horse'",
    ):
        assert part in told


def test_what_is_no_file_is_told_too(tmp_path):
    (tmp_path / "a.h5").write_bytes(b"hello")
    (problem,) = check_sequence(tmp_path / "a.h5")
    assert problem.where == str(tmp_path / "a.h5") and "not an HDF5 file" in problem.what and problem.do
