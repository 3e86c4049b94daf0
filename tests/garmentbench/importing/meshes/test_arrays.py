"""Arrays by name, as anybody writes them with NumPy or h5py."""

import io
import zipfile

import h5py
import numpy as np
import pytest
from exchange_example import MESHES

from garmentbench.errors import UserError
from garmentbench.importing.meshes.arrays import read_hdf5, read_npz, write_npz
from garmentbench.importing.meshes.reading import read_meshes

MESH = MESHES["garment"]
UV = np.zeros((len(MESH.still), 2), np.float32)
UV[MESH.faces.ravel()] = MESH.corner_uv.reshape(-1, 2)
GOOD = {"positions": MESH.frames, "faces": MESH.faces, "uv": UV, "fps": 25.0, "up": "z"}


def test_npz_of_numpy(tmp_path):
    np.savez_compressed(tmp_path / "a.npz", **GOOD | {"faces": MESH.faces.astype(np.uint16), "note": "anything"})
    read = read_npz(tmp_path / "a.npz")
    np.testing.assert_array_equal(read.frames, MESH.frames)
    np.testing.assert_array_equal(read.faces, MESH.faces)
    np.testing.assert_array_equal(read.corner_uv, MESH.corner_uv)
    assert (read.fps, read.up, read.unit, read.rest) == (25.0, "z", None, None)


def test_other_names_and_uv_by_corner(tmp_path):
    arrays = {
        "vertices": MESH.frames.astype(np.float64),
        "triangles": MESH.faces,
        "uv": MESH.corner_uv,
        "metres_per_unit": 0.01,
        "pins": np.array([3, 7]),
    }
    np.savez(tmp_path / "a.npz", **arrays)
    read = read_npz(tmp_path / "a.npz")
    np.testing.assert_array_equal(read.corner_uv, MESH.corner_uv)
    assert read.unit == 0.01 and read.pins.tolist() == [3, 7]


def test_what_is_written_is_read(tmp_path):
    write_npz(tmp_path / "a.npz", MESH)
    read = read_npz(tmp_path / "a.npz")
    for name in ("frames", "faces", "corner_uv", "rest", "pins"):
        np.testing.assert_array_equal(getattr(read, name), getattr(MESH, name))
    assert (read.fps, read.unit, read.up) == (25.0, 1.0, "z")


def test_hdf5_of_h5py_in_a_process_of_its_own(tmp_path):
    with h5py.File(tmp_path / "a.h5", "w") as file:
        for name, value in GOOD.items():
            file[name] = np.bytes_(value) if isinstance(value, str) else value
    read = read_meshes(str(tmp_path / "a.h5"))
    np.testing.assert_array_equal(read.frames, MESH.frames)
    np.testing.assert_array_equal(read.corner_uv, MESH.corner_uv)
    assert (read.fps, read.up, read.name) == (25.0, "z", "a")


@pytest.mark.parametrize("text", [str, np.bytes_])
@pytest.mark.parametrize("place", ["npz", "dataset", "file", "positions"])
def test_texts_of_any_kind_wherever_they_stand(tmp_path, place, text):
    said = {"fps": text("24"), "up": text("Z"), "units": text("Inches")}
    arrays = {k: v for k, v in GOOD.items() if k not in said}
    if place == "npz":
        np.savez(tmp_path / "a.npz", **arrays, **said)
        read = read_npz(tmp_path / "a.npz")
    else:
        with h5py.File(tmp_path / "a.h5", "w") as file:
            for name, value in arrays.items():
                file[name] = value
            holder = {"dataset": file, "file": file.attrs, "positions": file["positions"].attrs}[place]
            for name, value in said.items():
                holder[name] = value
        read = read_hdf5(tmp_path / "a.h5")
    assert (read.fps, read.up, read.unit) == (24.0, "z", 0.0254)


@pytest.mark.parametrize(
    ("said", "unit", "up"),
    [
        ("metre", 1.0, "y-up"),
        ("CM", 0.01, "+Y"),
        ("Millimeters", 0.001, "y_axis"),
        ("feet", 0.3048, "Y"),
        ("m", 1.0, "y"),
    ],
)
def test_names_of_units_and_axes(tmp_path, said, unit, up):
    np.savez(tmp_path / "a.npz", **GOOD | {"units": said, "up": up})
    read = read_npz(tmp_path / "a.npz")
    assert (read.unit, read.up) == (unit, "y")


BAD = [
    ({"units": "parsec"}, "units is 'parsec', wanted m, cm, mm, in, ft"),
    ({"units": "cm", "metres_per_unit": 1.0}, "units is 'cm', metres_per_unit 1; write only the one that is right"),
    ({"fps": "fast"}, "fps is fast, wanted one number above 0"),
    ({"positions": None}, "has no array 'positions' (found: faces, fps, up, uv)"),
    ({"positions": MESH.frames[0]}, "positions is float32 of shape (105, 3), wanted floats of shape (n, n, 3)"),
    ({"positions": np.zeros((0, 105, 3), np.float32)}, "positions is float32 of shape (0, 105, 3)"),
    ({"positions": MESH.frames.astype(np.int64)}, "positions is int64"),
    ({"faces": MESH.faces.astype(float)}, "faces is float64 of shape (168, 3), wanted whole numbers"),
    ({"faces": MESH.faces + 1}, "faces name vertices 1 to 105, wanted them counted from 0; subtract 1"),
    ({"faces": MESH.faces + 2}, "names vertices"),
    (
        {"positions": None, "garment_points": MESH.frames},
        "has no array 'positions' (found: faces, fps, garment_points, up, uv)",
    ),
    ({"positions": MESH.frames.transpose(2, 1, 0)}, "turn its axes round: MATLAB and Julia write the last first"),
    ({"faces": MESH.faces.T}, "turn its axes round"),
    ({"faces": MESH.faces - 1}, "names vertices"),
    ({"uv": UV[:-1]}, "uv is float32 of shape (104, 2), wanted floats of shape (105, 2) or (168, 3, 2)"),
    ({"rest": MESH.still[:-1]}, "rest has 104 vertices, positions have 105"),
    ({"pins": np.array([200])}, "pins name vertices up to 200, there are 105"),
    ({"fps": -1.0}, "fps is -1.0, wanted one number above 0"),
    ({"fps": float("nan")}, "fps is nan"),
    ({"fps": np.array([1.0, 2.0])}, "fps is [1. 2.]"),
    ({"up": "sky"}, "up is 'sky', wanted x, y or z"),
]


@pytest.mark.parametrize(("change", "says"), BAD)
@pytest.mark.parametrize("kind", ["npz", "h5"])
def test_odd_arrays_are_refused_in_one_line(tmp_path, change, says, kind):
    arrays = {k: v for k, v in (GOOD | change).items() if v is not None}
    path = tmp_path / f"a.{kind}"
    if kind == "npz":
        np.savez(path, **arrays)
    else:
        with h5py.File(path, "w") as file:
            for name, value in arrays.items():
                file[name] = np.bytes_(value) if isinstance(value, str) else value
    refused(path, says)


def refused(path, says):
    with pytest.raises(UserError) as error:
        (read_npz if path.suffix == ".npz" else read_hdf5)(path)
    message = str(error.value)
    assert message.startswith(str(path)) and says in message and "\n" not in message


def archive(path, header: bytes, body: bytes = b"") -> None:
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as file:
        file.writestr("positions.npy", header + body)


def header_of(shape: tuple, dtype: str = "<f4") -> bytes:
    out = io.BytesIO()
    np.lib.format.write_array_header_1_0(out, {"descr": dtype, "fortran_order": False, "shape": shape})
    return out.getvalue()


def test_npz_claims_are_compared_with_the_file(tmp_path):
    archive(tmp_path / "a.npz", header_of((10**6, 10**6, 3)))
    refused(tmp_path / "a.npz", "positions.npy claims 12000000000000 bytes in a file of")
    archive(
        tmp_path / "b.npz", header_of((3000, 10**4, 3)), bytes(12 * 3000 * 10**4)
    )  # zeros, a thousandfold compressed
    refused(tmp_path / "b.npz", "positions.npy claims 360000000 bytes in a file of")


def test_npz_with_python_objects_is_not_unpickled(tmp_path):
    np.savez(tmp_path / "a.npz", positions=np.array([{}], dtype=object), allow_pickle=True)
    refused(tmp_path / "a.npz", "holds Python objects, wanted numbers")


def test_hdf5_claims_are_compared_with_the_file(tmp_path):
    with h5py.File(tmp_path / "a.h5", "w") as file:
        file.create_dataset("positions", (10**6, 10**4, 3), "float32", chunks=(1, 1000, 3))
    refused(tmp_path / "a.h5", "positions claims 120000000000 bytes in a file of")
