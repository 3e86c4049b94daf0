"""Garment and body are paired by their times, in every format that has times."""

from dataclasses import replace
from pathlib import Path

import h5py
import numpy as np
import pytest
from cache_example import FORMATS, STATE_RATE, T, alembic, hdf5, mdd, moving, npz, obj, pc2, run, usd
from exchange_example import MESHES, imported, typed

from garmentbench.errors import UserError
from garmentbench.importing.meshes.arrays import write_npz
from garmentbench.importing.meshes.conventions import Given
from garmentbench.importing.meshes.pairing import paired
from garmentbench.importing.meshes.reading import read_both
from garmentbench.importing.sequences import Wanted, import_meshes


def fps_of(write) -> tuple:
    return () if write in STATE_RATE else ("--fps", "25")


def together(path: Path) -> int:
    """The number of frames, garment and body all at the same place of their motion."""
    sequence = imported(path)
    moved = [(x - x[0]).mean(axis=1)[:, 0] for x in (sequence.garment, sequence.body)]
    np.testing.assert_allclose(moved[0], moved[1], atol=1e-5)
    gap = sequence.garment[0, :, 0].mean() - sequence.body[0, :, 0].mean()
    rest = MESHES["garment"].frames[0, :, 0].mean() - MESHES["body"].frames[0, :, 0].mean()
    assert gap == pytest.approx(rest, abs=2e-3)  # vertices that the UV map's cuts double shift the mean a little
    return len(sequence)


@pytest.mark.parametrize("write", FORMATS)
def test_another_start_leaves_the_frames_that_both_have(tmp_path, capsys, write):
    code, out, err = run(tmp_path, capsys, write, (3.0, 1.0), (0.0, 1.0), *fps_of(write))
    assert code == 0 and err == [] and "frames: 5 that both have" in out
    assert together(tmp_path / "x.h5") == 5 and imported(tmp_path / "x.h5").template.fps == 25


@pytest.mark.parametrize("write", FORMATS)
def test_another_rate_leaves_the_frames_that_both_have(tmp_path, capsys, write):
    code, out, err = run(tmp_path, capsys, write, (0.0, 2.0), (0.0, 1.0), *fps_of(write))
    assert code == 0 and err == [] and "frames: 4 that both have" in out
    assert together(tmp_path / "x.h5") == 4 and imported(tmp_path / "x.h5").template.fps == 12.5


@pytest.mark.parametrize("write", FORMATS)
def test_no_common_frame_is_refused_and_a_same_start_is_an_option(tmp_path, capsys, write):
    code, _, err = run(tmp_path, capsys, write, (40.0, 1.0), (0.0, 1.0), *fps_of(write))
    assert code == 1 and len(err) == 1 and "no frame in common" in err[0] and "--same-start" in err[0]
    (tmp_path / "again").mkdir()
    code, out, _ = run(tmp_path / "again", capsys, write, (40.0, 1.0), (0.0, 1.0), "--same-start", *fps_of(write))
    assert code == 0 and "frames: 8 that both have" in out and len(imported(tmp_path / "again" / "x.h5")) == 8


@pytest.mark.parametrize("write", [mdd, npz, usd, alembic])
def test_rates_that_dont_fit_and_a_given_rate_that_contradicts(tmp_path, capsys, write):
    code, _, err = run(tmp_path, capsys, write, (0.0, 1.25), (0.0, 1.0))
    assert code == 1 and len(err) == 1 and "the rates don't fit together" in err[0] and "--frames" not in err[0]
    (tmp_path / "again").mkdir()
    code, _, err = run(tmp_path / "again", capsys, write, (0.0, 2.0), (0.0, 1.0), "--fps", "25")
    assert code == 1 and "leave --fps out" in err[0]


def test_equal_rates_that_are_wrong_are_mended_by_fps(tmp_path, capsys):
    code, out, _ = run(tmp_path, capsys, mdd, (3.0, 1.0), (0.0, 1.0), "--fps", "50")
    assert code == 0 and together(tmp_path / "x.h5") == 5 and imported(tmp_path / "x.h5").template.fps == 50


def test_numbers_beside_times_may_count_from_one(tmp_path, capsys):
    code, out, _ = run(tmp_path, capsys, pc2, (0.0, 1.0), (0.0, 1.0), write_body=usd)
    assert code == 0 and "taken to begin together" in out and together(tmp_path / "x.h5") == 8
    (tmp_path / "again").mkdir()
    code, out, _ = run(tmp_path / "again", capsys, pc2, (4.0, 1.0), (0.0, 1.0), write_body=mdd)
    assert code == 0 and "taken as times at 25 a second" in out and together(tmp_path / "again" / "x.h5") == 4


@pytest.mark.parametrize(("write", "write_body", "more"), [(pc2, obj, ("--fps", "25")), (mdd, usd, ()), (mdd, npz, ())])
def test_formats_that_count_from_one_and_from_zero_begin_together(tmp_path, capsys, write, write_body, more):
    """As many frames, one apart: PC2's 0 is OBJ's 1, and MDD's 0 s USD's time code 1. In one format it is meant."""
    first = {usd: 0.0, obj: -99.0, npz: 1.0}[write_body]  # these write time code 1 and file 100 for frame 0
    call = (tmp_path, capsys, write, (0.0, 1.0), (first, 1.0), *more)
    code, out, err = run(*call, write_body=write_body)
    assert code == 0 and err == [] and "count from 0 or 1; taken to begin together" in out
    assert len(imported(tmp_path / "x.h5")) == T
    (tmp_path / "again").mkdir()
    code, out, _ = run(tmp_path / "again", capsys, mdd, (0.0, 1.0), (1.0, 1.0))
    assert code == 0 and "frames: 7 that both have" in out and together(tmp_path / "again" / "x.h5") == 7


@pytest.mark.parametrize("write", FORMATS)
def test_a_single_common_frame_is_no_motion(tmp_path, capsys, write):
    code, _, err = run(tmp_path, capsys, write, (7.0, 1.0), (0.0, 1.0), *fps_of(write))
    assert code == 1 and len(err) == 1 and "only one frame in common" in err[0]


@pytest.mark.parametrize(("write", "every"), [(pc2, 0.5), (pc2, 2.0), (pc2, 10.0), (obj, 2.0)])
def test_fps_is_of_the_frames_that_files_number(tmp_path, capsys, write, every):
    """A sample every half frame of 24 is 48 a second, every second file 12; garment and body alike, or one alone."""
    code, out, err = run(tmp_path, capsys, write, (0.0, every), (0.0, every), "--fps", "24")
    assert code == 0 and err == [] and f"of which it has one every {every:g}: {24 / every:g} a second" in out
    assert ("slow for cloth" in out) == (every == 10)
    assert imported(tmp_path / "x.h5").template.fps == 24 / every and together(tmp_path / "x.h5") == T
    (tmp_path / "again").mkdir()
    files = write(tmp_path / "again", "garment", moving("garment", 0, every), 0.0, every)
    call = ("import", files[0], "--template", files[1], "--units", "m", "--up", "z", "--fps", "24")
    assert typed(capsys, *call, "--out", tmp_path / "y.h5")[0] == 0
    assert imported(tmp_path / "y.h5").template.fps == 24 / every


def test_a_sampling_that_leaves_no_rate_is_refused(tmp_path, capsys):
    code, _, err = run(tmp_path, capsys, pc2, (0.0, 40.0), (0.0, 40.0), "--fps", "25")
    assert code == 2 and len(err) == 1 and "one every 40: 0.625 a second, wanted 1 to 1000" in err[0]


@pytest.mark.parametrize("write", [pc2, obj])
@pytest.mark.parametrize("write_body", [mdd, npz, usd, alembic])
def test_a_rate_that_contradicts_the_other_file_is_refused_without_bad_advice(tmp_path, capsys, write, write_body):
    """PC2 and OBJ say no rate: the other file's is taken, with a word."""
    start = 0.0 if write is pc2 else -100.0  # these files are numbered from 100
    call = (capsys, write, (5.0 + start, 1.0), (0.0, 1.0))
    code, _, err = run(tmp_path, *call, "--fps", "24", write_body=write_body)
    assert code == 1 and len(err) == 1 and "--fps is 24, but" in err[0] and "states 25 frames a second" in err[0]
    assert "leave --fps out" in err[0] and "--same-start" not in err[0]
    (tmp_path / "again").mkdir()
    code, out, _ = run(tmp_path / "again", *call, write_body=write_body)
    assert code == 0 and "says no rate: 25 a second, as" in out and "taken as times at 25 a second" in out
    offset = int(write_body in (usd, alembic))  # these count from 1 here
    assert len(imported(tmp_path / "again" / "x.h5")) == T - 5 + offset


def test_same_start_is_advised_only_where_it_helps(tmp_path, capsys):
    """Not where it was just given, nor where the garment then leaves its body, which goes another way."""
    code, _, err = run(tmp_path, capsys, mdd, (0.0, 1.25), (0.0, 1.0), "--same-start")
    assert code == 1 and "--same-start" not in err[0]
    garment, body = (replace(moving(n), times=np.arange(T) / 25) for n in ("garment", "body"))
    turned = replace(body, times=body.times + 40, frames=body.frames[::-1])
    for other, helps in ((replace(body, times=body.times + 40), True), (turned, False)):
        with pytest.raises(UserError, match="no frame in common") as e:
            paired(garment, other, None)
        assert ("--same-start, which pairs 8 frames" in str(e.value)) == helps


def numbered(write):
    """The same with the numbers of frames where times should be."""
    return lambda folder, name, mesh, start, every: write(folder, name, mesh, 25 * start, 25 * every)


def test_times_that_are_numbers_of_frames_are_known_in_one_file_too(tmp_path, capsys):
    code, out, err = run(tmp_path, capsys, numbered(mdd), (3.0, 1.0), (0.0, 1.0), write_body=npz)
    assert code == 0 and err == [] and "are whole numbers, taken as numbers of frames" in out
    assert "says no rate: 25 a second" in out and together(tmp_path / "x.h5") == 5
    (tmp_path / "again").mkdir()
    code, _, err = run(tmp_path / "again", capsys, numbered(mdd))
    assert code == 1 and "the files don't say how many frames a second they have; give --fps" in err[0]
    (tmp_path / "third").mkdir()
    code, _, _ = run(tmp_path / "third", capsys, numbered(mdd), (0.0, 1.0), (0.0, 1.0), "--fps", "25")
    assert code == 0 and imported(tmp_path / "third" / "x.h5").template.fps == 25


@pytest.mark.parametrize("write", [npz, hdf5])
def test_arrays_of_numbers_of_frames_beside_a_rate(tmp_path, capsys, write):
    code, out, _ = run(tmp_path, capsys, numbered(write), (3.0, 1.0), (0.0, 1.0), write_body=mdd)
    assert code == 0 and "its times are whole numbers, taken as numbers of frames, 25 a second" in out
    assert together(tmp_path / "x.h5") == 5


def test_two_rates_of_which_one_stands_in_a_sampling_are_no_pair(tmp_path, capsys):
    def stated(folder, name, mesh, start, every):
        return pc2(folder, name, mesh, start, 30.0)

    code, _, err = run(tmp_path, capsys, stated, write_body=mdd)
    assert code == 1 and len(err) == 1 and "the rates don't fit together" in err[0] and "--same-start" not in err[0]


def test_a_rate_that_one_file_says_is_told(tmp_path, capsys):
    body = replace(moving("body"), fps=None)
    _, notes = import_meshes(moving("garment"), body, Wanted("x", Given("m", "z"), kind="object"))
    assert "fps: 25 (as the garment's file says; the body's says nothing)" in notes


def test_two_meanings_of_a_sampling_are_asked_about(tmp_path, capsys):
    """24 is every 24th frame, or frames a second; 1 beside it doesn't tell."""
    code, _, err = run(tmp_path, capsys, pc2, (0.0, 24.0), (0.0, 1.0), "--fps", "24")
    assert (
        code == 1 and len(err) == 1 and "its sampling is 24" in err[0] and "frames a second, or every so many" in err[0]
    )
    (tmp_path / "again").mkdir()
    code, out, _ = run(tmp_path / "again", capsys, pc2, (0.0, 24.0), (0.0, 24.0))
    assert code == 0 and "fps: 24 (as the file says)" in out and out.count("its sampling of 24 is taken as frames") == 2


def test_a_body_that_stands_still_has_no_time():
    still = replace(MESHES["body"], frames=MESHES["body"].frames[:1], times=np.array([100.0]))
    cloth = replace(moving("garment"), times=np.arange(T) / 25)
    assert paired(cloth, still, None).garment is cloth


def test_without_times_counts_must_agree_and_the_advice_is_only_then(tmp_path, capsys):
    for name, count in (("garment", T), ("body", 5)):
        mesh = moving(name)
        write_npz(tmp_path / f"{name}.npz", replace(mesh, frames=mesh.frames[:count]))
    files = (tmp_path / "garment.npz", "--body", tmp_path / "body.npz", "--kind", "object", "--out", tmp_path / "x.h5")
    code, _, err = typed(capsys, "import", *files)
    assert code == 1 and "--frames 5 where both begin at the same time" in err[0]


def test_hdf5_texts_and_numbers_as_attributes(tmp_path):
    mesh = moving("garment")
    for kind in (h5py.string_dtype(), "S1"):
        with h5py.File(tmp_path / "a.h5", "w") as file:
            file["positions"], file["faces"], file["uv"] = mesh.frames, mesh.faces, mesh.corner_uv
            file.attrs["fps"], file.attrs["metres_per_unit"] = 25.0, 1.0
            file.attrs.create("up", "z", dtype=kind)
        read, _ = read_both((str(tmp_path / "a.h5"), None, ""), ("", None, ""))
        assert (read.fps, read.unit, read.up) == (25.0, 1.0, "z")
    with h5py.File(tmp_path / "b.h5", "w") as file:
        file["positions"], file["faces"] = mesh.frames, mesh.faces
        file.create_dataset("up", data="y", dtype=h5py.string_dtype())
    assert read_both((str(tmp_path / "b.h5"), None, ""), ("", None, ""))[0].up == "y"
