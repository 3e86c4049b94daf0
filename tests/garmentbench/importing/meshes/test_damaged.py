"""Readers on files that are cut off or spoilt: one line or a good mesh, never a crash, a hang or a large allocation."""

import io
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from exchange_example import MESHES

from garmentbench.errors import UserError
from garmentbench.importing.meshes.arrays import write_npz
from garmentbench.importing.meshes.obj import read_template, write_template
from garmentbench.importing.meshes.point_caches import read_mdd, read_pc2, write_mdd, write_pc2
from garmentbench.importing.meshes.reading import read_meshes

MESH = MESHES["garment"]
WRITERS = {"obj": write_template, "pc2": write_pc2, "mdd": write_mdd, "npz": write_npz}


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """Bytes of a good file of each kind."""
    folder = tmp_path_factory.mktemp("whole")
    for ending, write in WRITERS.items():
        write(folder / f"a.{ending}", MESH)
    return {ending: (folder / f"a.{ending}").read_bytes() for ending in WRITERS}


@pytest.fixture
def read(tmp_path, whole):
    """Read such bytes; the line of complaint, or None where all is well."""
    (tmp_path / "template.obj").write_bytes(whole["obj"])
    template = read_template(tmp_path / "template.obj")
    caches = {"pc2": read_pc2, "mdd": read_mdd}

    def read(ending: str, content: bytes) -> str | None:
        path = tmp_path / f"a.{ending}"
        path.unlink(missing_ok=True)  # a mapped file must not change
        path.write_bytes(content)
        try:
            mesh = caches[ending](path, template) if ending in caches else read_meshes(str(path))
        except UserError as e:
            assert "\n" not in str(e) and str(e).startswith(str(path)), repr(e)
            return str(e)
        assert mesh.frames.ndim == 3 and mesh.faces.max() < mesh.frames.shape[1]
        return None

    return read


@pytest.mark.parametrize("ending", ["pc2", "mdd", "npz"])
def test_binary_files_cut_off_anywhere_are_refused(read, whole, ending):
    content = whole[ending]
    cuts = {
        *range(64),
        *np.linspace(64, len(content) - 1, 120).astype(int).tolist(),
        *range(len(content) - 24, len(content)),
    }
    for cut in sorted(cuts):
        assert read(ending, content[:cut]) is not None, cut


def test_obj_files_cut_off_anywhere(read, whole):
    """Cut between two faces, or in a face's last index, a text is a smaller good mesh; anywhere else it is refused."""
    content = whole["obj"]
    first_face = content.index(b"\nf ") + 1
    for cut in np.linspace(0, first_face + 2, 150).astype(int):
        assert read("obj", content[:cut]) is not None, cut
    for cut in range(len(content) - 150, len(content)):
        read("obj", content[:cut])


@pytest.mark.parametrize("ending", WRITERS)
def test_spoilt_bytes(read, whole, ending):
    rng = np.random.default_rng(0)
    content = whole[ending]
    places = np.concatenate([rng.integers(0, len(content), 150), rng.integers(0, min(200, len(content)), 150)])
    for place in places:
        spoilt = bytearray(content)
        spoilt[place] ^= 1 << int(rng.integers(8))
        read(ending, bytes(spoilt))


@pytest.mark.parametrize("ending", WRITERS)
def test_noise_and_other_formats_bytes(read, whole, ending):
    rng = np.random.default_rng(1)
    for size in (1, 8, 32, 1000, 100_000):
        assert read(ending, rng.bytes(size)) is not None
        assert read(ending, b"\0" * size) is not None
    for other, content in whole.items():
        if other != ending:
            assert read(ending, content) is not None, other


def test_a_spoilt_hdf5_file_in_a_process_of_its_own(tmp_path, whole):
    """Few cases, since each is a process."""
    import h5py

    image = io.BytesIO()
    with h5py.File(image, "w") as file:
        file["positions"], file["faces"] = MESH.frames, MESH.faces
    content, path = image.getvalue(), tmp_path / "a.h5"
    for place in (8, 40, 100, 200, len(content) // 2):
        spoilt = bytearray(content)
        spoilt[place] ^= 0xFF
        for broken in (content[:place], bytes(spoilt)):
            path.write_bytes(broken)
            try:
                read_meshes(str(path))
            except UserError as e:
                assert "\n" not in str(e) and str(e).startswith(str(path))


CLAIMS = {
    "pc2": b"POINTCACHE2\0"
    + np.array([1, 40_000], "<i4").tobytes()
    + np.zeros(2, "<f4").tobytes()
    + np.array([20_000], "<i4").tobytes(),
    "mdd": np.array([20_000, 40_000], ">i4").tobytes(),
}


@pytest.mark.parametrize("ending", CLAIMS)
def test_a_header_s_claim_is_not_allocated(tmp_path, whole, ending):
    """9.6 GB in a header of a file of a few bytes, read by a process that may have no more than it has."""
    (tmp_path / "a.obj").write_bytes(whole["obj"])
    (tmp_path / f"a.{ending}").write_bytes(CLAIMS[ending] + b"\0" * 100)
    code = f"""
import resource, sys
from garmentbench.importing.meshes.reading import read_meshes
from garmentbench.errors import UserError
from pathlib import Path
used = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
resource.setrlimit(resource.RLIMIT_AS, (used + (64 << 20), used + (64 << 20)))
try:
    read_meshes("a.{ending}", Path("a.obj"))
except UserError as e:
    sys.exit(str(e))
"""
    root = Path(__file__).parents[4]
    done = subprocess.run(
        [sys.executable, "-c", code],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        timeout=60,
        env={"PYTHONPATH": str(root), "OMP_NUM_THREADS": "1"},
    )
    assert done.returncode == 1 and "wants 9600" in done.stderr and done.stderr.count("\n") == 1, done.stderr
