"""Units, up axis and rate: given before stated before inferred, and what is unclear is asked for."""

import numpy as np
import pytest

from garmentbench.errors import UsageError, UserError
from garmentbench.importing.meshes.conventions import AXES, UNITS, Given, converter, find_conventions
from garmentbench.importing.meshes.mesh_sequence import MeshSequence

FACE = np.array([[0, 1, 2]], np.int32)


def box(size, low=None, **more):
    """A mesh of two vertices that measures `size`, its lowest corner at `low` (by default 0)."""
    low = np.zeros(3) if low is None else np.asarray(low, float)
    return MeshSequence("box", np.array([[low, low + size]], np.float32).repeat(2, axis=0), FACE, **more)


CLOTH = box([50, 60, 30])


def settle(body, cloth=CLOTH, given=Given(fps=30.0), human=True):
    return find_conventions(cloth, body, given, human)


@pytest.mark.parametrize("up", AXES)
def test_axes_turn_and_never_mirror(up):
    matrix = converter(0.01, up)
    assert np.linalg.det(matrix) == pytest.approx(1e-6)
    axis = np.zeros(3)
    axis["xyz".index(up[-1])] = -100 if up[0] == "-" else 100
    np.testing.assert_allclose(matrix @ axis, [0, 0, 1], atol=1e-12)


def test_y_up_keeps_left_and_turns_the_front_to_minus_y():
    matrix = converter(1.0, "y")
    np.testing.assert_array_equal(matrix @ [1, 0, 0], [1, 0, 0])
    np.testing.assert_array_equal(matrix @ [0, 0, 1], [0, -1, 0])


@pytest.mark.parametrize(("height", "unit"), [(1.78, "m"), (178, "cm"), (1780, "mm"), (70, "in"), (5.8, "ft")])
@pytest.mark.parametrize("axis", range(3))
def test_a_standing_body_tells_unit_and_up(height, unit, axis):
    size = np.full(3, 0.3 * height)
    size[axis] = height
    found = settle(box(size))
    assert found.unit == (UNITS[unit], UNITS[unit]) and found.up == ("xyz"[axis],) * 2
    assert found.assumed[0] == f"units: {unit} (inferred: body height {height:.4g})"
    assert found.assumed[1].startswith(f"up: {'xyz'[axis]} (inferred: the body measures")


def test_a_t_pose_tells_up_by_where_it_stands():
    found = settle(box([175, 170, 30], low=[-87, 0.5, -15]))
    assert found.up == ("y", "y") and "stands at 0 along y" in found.assumed[1]
    with pytest.raises(UserError, match=r"up axis: can't be told from a body of 175 x 170 x 30; give --up y"):
        settle(box([175, 170, 30], low=[-87, 40, -15]))


@pytest.mark.parametrize("height", [0.3, 3, 30, 99, 300, 1e6, 1e-9])
def test_an_odd_height_is_asked_about(height):
    with pytest.raises(UserError, match=r"units: can't be told from body height .*; give --units \(m, cm"):
        settle(box([height / 4, height / 4, height]))


@pytest.mark.parametrize(("size", "unit"), [(0.9, "m"), (90, "cm"), (900, "mm")])
def test_a_garment_alone_tells_its_unit_but_not_its_up(size, unit):
    cloth = box([size, 0, 0])
    assert settle(None, cloth, Given(up="y", fps=30.0)).unit[0] == UNITS[unit]
    with pytest.raises(UserError, match="up axis: can't be told without a human body"):
        settle(None, cloth)


def test_given_before_stated_before_inferred():
    stated = box([0.4, 0.4, 1.8], fps=24.0, unit=0.01, up="x")
    assert settle(stated, given=Given()).assumed == tuple(
        f"{line} (as the body's file says; the garment's says nothing)" for line in ("units: cm", "up: x", "fps: 24")
    )
    assert settle(stated, stated, Given()).assumed[0] == "units: cm (as the file says)"
    found = settle(stated, given=Given("in", "-y", 60.0))
    assert (found.unit, found.up, found.fps) == ((0.0254, 0.0254), ("-y", "-y"), 60.0)
    assert found.assumed == ("units: in (given)", "up: -y (given)", "fps: 60 (given)")


def test_each_file_keeps_what_it_states():
    found = settle(box([0.4, 0.4, 1.8], unit=1.0, up="z"), box([50, 60, 30], unit=0.01, up="y"))
    assert found.unit == (0.01, 1.0) and found.up == ("y", "z")
    assert found.assumed[0] == "units: cm, of the body m (as the file says)"


def test_rates():
    with pytest.raises(UserError, match="fps: the files don't say .* give --fps, e.g. --fps 30"):
        settle(box([40, 40, 178]), given=Given())
    with pytest.raises(UserError, match="the garment has 24 frames a second, the body 30"):
        settle(box([40, 40, 178], fps=30.0), box([50, 60, 30], fps=24.0), Given())


def test_times_that_are_numbers_of_frames_are_asked_about():
    """MDD of programs that write frames for seconds: one frame a second."""
    body = box([40, 40, 178], fps=1.0)
    with pytest.raises(
        UserError,
        match=r"fps: the files say 1 frames a second: are their times milliseconds, or numbers of frames\? Give",
    ):
        settle(body, box([50, 60, 30], fps=1.0), Given())
    assert settle(body, box([50, 60, 30], fps=1.0), Given(fps=24.0)).fps == 24.0


@pytest.mark.parametrize(
    ("given", "says"),
    [({"units": "km"}, "--units is 'km'"), ({"up": "w"}, "--up is 'w'"), ({"fps": 0.0}, "--fps is 0")],
)
def test_what_is_given_wrongly(given, says):
    with pytest.raises(UsageError, match=says):
        Given(**given)


def test_an_object_tells_nothing():
    with pytest.raises(UserError, match="up axis"):
        settle(box([3, 3, 100]), human=False)
