"""Sequences come back as they were written; what is not a whole sequence file is refused in one line."""

import subprocess
import sys
from dataclasses import replace

import h5py
import numpy as np
import pytest

from garmentbench.errors import UserError
from garmentbench.evaluation.toy import tiny_sequence
from garmentbench.sequence_file.read_write import content_hash, load, save

KINDS = ("human", "object", "garment", None)


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """The bytes of a good file."""
    path = tmp_path_factory.mktemp("whole") / "tiny.h5"
    save(tiny_sequence(20), path)
    return path.read_bytes()


def one_line(error: pytest.ExceptionInfo) -> str:
    message = str(error.value)
    assert "\n" not in message
    return message


@pytest.mark.parametrize("kind", KINDS)
def test_nothing_is_rounded_or_lost(tmp_path, kind):
    written = tiny_sequence(20, kind)
    rng = np.random.default_rng(0)
    noise = rng.normal(size=written.garment.shape).astype(np.float32) * 1e-7
    written = replace(written, garment=written.garment + noise, info={"scene": "x", "note": "y" * 100_000})
    save(written, tmp_path / "a.h5")
    read = load(tmp_path / "a.h5")
    assert read.garment.dtype == np.float32 and read.garment.tobytes() == written.garment.tobytes()
    for name in ("rest", "faces", "uv", "seams", "pins"):
        np.testing.assert_array_equal(getattr(read.template.garment, name), getattr(written.template.garment, name))
    assert read.info == written.info and read.template.fps == 30.0
    assert read.template.needs == written.template.needs
    if kind is None:
        assert read.body is None and read.template.body is None
    else:
        body = written.template.body
        assert read.body.tobytes() == written.body.tobytes()
        assert (read.template.body.name, read.template.body.part_names) == (body.name, body.part_names)
        assert (read.template.body.labels is None) == (kind != "human")


def test_same_sequence_same_bytes(tmp_path, whole):
    save(tiny_sequence(20), tmp_path / "again.h5")
    assert (tmp_path / "again.h5").read_bytes() == whole


def test_the_hash_is_of_content_not_of_timings(tmp_path):
    sequence = tiny_sequence(20)
    moved = sequence.garment.copy()
    moved[7, 3, 1] = np.nextafter(moved[7, 3, 1], 9)
    hashes = []
    for changed in (sequence, replace(sequence, info={"ms": 3}), replace(sequence, garment=moved)):
        save(changed, tmp_path / "a.h5")
        hashes.append(content_hash(tmp_path / "a.h5"))
    assert hashes[0] == hashes[1] != hashes[2] and len(hashes[0]) == 64


@pytest.mark.parametrize("runs", [1, 3])
def test_further_runs_come_back_also_where_one_broke(tmp_path, runs):
    written = tiny_sequence(20, runs=runs)
    written.runs[-1, 7:] = np.nan
    save(written, tmp_path / "a.h5")
    read = load(tmp_path / "a.h5")
    assert read.runs.dtype == np.float32 and read.runs.tobytes() == written.runs.tobytes()
    part = load(tmp_path / "a.h5", frames=5)
    assert np.array_equal(part.runs, written.runs[:, :5]) and np.isfinite(part.runs).all()
    assert np.array_equal(written.frames(3, 9).runs, written.runs[:, 3:9], equal_nan=True)
    with h5py.File(tmp_path / "a.h5") as file:
        assert file["garment/runs"].chunks == (1, 16, 105, 3)
        assert file["garment/frames"].chunks == (16, 105, 3)


def test_runs_are_part_of_the_content(tmp_path, whole):
    save(tiny_sequence(20, runs=2), tmp_path / "a.h5")
    (tmp_path / "alone.h5").write_bytes(whole)
    assert content_hash(tmp_path / "a.h5") != content_hash(tmp_path / "alone.h5")
    assert load(tmp_path / "alone.h5").runs is None


def test_the_first_frames_only(tmp_path, whole):
    (tmp_path / "a.h5").write_bytes(whole)
    part = load(tmp_path / "a.h5", frames=5)
    np.testing.assert_array_equal(part.garment, tiny_sequence(20).garment[:5])
    assert part.body.shape[0] == 5


def test_cut_files_are_refused(tmp_path, whole):
    path = tmp_path / "cut.h5"
    for cut in np.linspace(0, len(whole) - 1, 60).astype(int):
        path.write_bytes(whole[:cut])
        with pytest.raises(UserError) as error:
            load(path)
        assert "garmentbench" in one_line(error), cut


def test_cut_files_with_runs_are_refused(tmp_path):
    save(tiny_sequence(20, runs=3), tmp_path / "a.h5")
    whole = (tmp_path / "a.h5").read_bytes()
    for cut in np.linspace(0, len(whole) - 1, 30).astype(int):
        (tmp_path / "cut.h5").write_bytes(whole[:cut])
        with pytest.raises(UserError) as error:
            load(tmp_path / "cut.h5")
        one_line(error)


def test_a_changed_byte_is_refused_or_harmless(tmp_path, whole):
    """In a process of its own: a crash inside the HDF5 library would be a failure too."""
    (tmp_path / "whole.h5").write_bytes(whole)
    code = """
import sys, numpy as np
from pathlib import Path
from garmentbench.errors import UserError
from garmentbench.sequence_file.read_write import load
folder = Path(sys.argv[1]); whole = (folder / "whole.h5").read_bytes(); good = load(folder / "whole.h5")
rng, refused = np.random.default_rng(0), 0
for at in rng.integers(0, len(whole), 120):
    broken = bytearray(whole); broken[at] ^= int(rng.integers(1, 256))
    (folder / "broken.h5").write_bytes(broken)
    try:
        read = load(folder / "broken.h5")
        assert read.garment.tobytes() == good.garment.tobytes() and read.body.tobytes() == good.body.tobytes(), at
    except UserError as e:
        assert "\\n" not in str(e), at
        refused += 1
print(refused)
"""
    done = subprocess.run([sys.executable, "-c", code, tmp_path], capture_output=True, text=True, timeout=60)
    assert done.returncode == 0, done.stderr
    assert int(done.stdout) > 60


@pytest.mark.parametrize("limit", [0, 1_000, 20_000, 50_000])
def test_a_disk_that_fills_leaves_nothing(tmp_path, limit, whole):
    assert limit < len(whole)
    code = f"""
import resource, sys
from pathlib import Path
from garmentbench.errors import UserError
from garmentbench.sequence_file.read_write import save
from garmentbench.evaluation.toy import tiny_sequence
sys.dont_write_bytecode = True  # a module compiled now would be cut off, and stay so
resource.setrlimit(resource.RLIMIT_FSIZE, ({limit}, {limit}))
try:
    save(tiny_sequence(20), Path(sys.argv[1]))
except UserError as e:
    sys.exit(f"refused: {{e}}")
"""
    path = tmp_path / "tiny.h5"
    done = subprocess.run([sys.executable, "-c", code, path], capture_output=True, text=True, timeout=60)
    assert done.returncode == 1 and done.stderr.startswith("refused: ") and str(path) in done.stderr
    assert list(tmp_path.iterdir()) == []


def test_an_older_file_stays_when_the_new_one_is_refused(tmp_path, whole):
    path = tmp_path / "a.h5"
    path.write_bytes(whole)
    broken = tiny_sequence(20)
    broken.garment[7, 2] = np.nan
    with pytest.raises(UserError, match="garment/frames: NaN or infinite at frame 7, vertex 2"):
        save(broken, path)
    assert path.read_bytes() == whole


@pytest.mark.parametrize(
    ("content", "says"),
    [
        (None, "no such file"),
        (b"", "an empty file"),
        (b"v 0 0 0\nf 1 2 3\n", "not an HDF5 file"),
        (b"\x89HDF\r\n\x1a\n" + b"\0" * 500, "truncated or damaged"),
    ],
)
def test_what_is_no_sequence(tmp_path, content, says):
    path = tmp_path / "a.h5"
    if content is not None:
        path.write_bytes(content)
    for read in (load, content_hash):
        with pytest.raises(UserError, match=says) as error:
            read(path)
        assert one_line(error).startswith(str(path)) and "make it again" in str(error.value)


def test_a_folder_is_no_sequence(tmp_path):
    with pytest.raises(UserError, match="a folder"):
        load(tmp_path)


@pytest.mark.parametrize(
    ("attributes", "says"),
    [
        ({"schema": 3}, "schema 3 is newer than schema 2, which is read here; update garmentbench"),
        ({"schema": 1}, "schema 1 is older than schema 2, which is read here; make it again"),
        ({"schema": 0}, "older"),
        ({"schema": "one"}, "older"),
        ({"format": "somebody's mesh"}, "an HDF5 file, but not a garmentbench sequence"),
        ({"format": "garmentbench roll-out"}, "an HDF5 file, but not a garmentbench sequence"),
    ],
)
def test_foreign_and_other_schemas(tmp_path, whole, attributes, says):
    path = tmp_path / "a.h5"
    path.write_bytes(whole)
    with h5py.File(path, "r+") as file:
        file.attrs.update({k: np.bytes_(v) if isinstance(v, str) else v for k, v in attributes.items()})
    with pytest.raises(UserError, match=says):
        load(path)


def test_a_file_that_claims_to_be_huge_is_not_believed(tmp_path, whole):
    path = tmp_path / "a.h5"
    path.write_bytes(whole)
    with h5py.File(path, "r+") as file:
        del file["garment/frames"]
        file.create_dataset("garment/frames", (10**6, 105, 3), "float32", chunks=(16, 105, 3), compression="gzip")
    with pytest.raises(UserError, match=r"garment/frames: can't be read \(garment/frames claims 1260000000 bytes"):
        load(path)


def test_arrays_elsewhere_are_not_followed(tmp_path, whole):
    path = tmp_path / "a.h5"
    path.write_bytes(whole)
    with h5py.File(path, "r+") as file:
        del file["garment/frames"]
        file["garment/frames"] = h5py.ExternalLink("/etc/passwd", "/frames")
    with pytest.raises(UserError, match="not an array of numbers in this file"):
        load(path)
