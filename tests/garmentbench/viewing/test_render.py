import numpy as np
import pytest

from garmentbench.viewing.render import BACKGROUND, RenderMesh, bounds, error_colours, render

QUAD = np.array([[-1, 0, -1], [1, 0, -1], [1, 0, 1], [-1, 0, 1]], np.float32)  # faces -y, as a body does
FACES = np.array([[0, 1, 2], [0, 2, 3]])
BOX = np.array([[-2.0, -0.1, -2.0], [2.0, 0.1, 2.0]])
RED, BLUE = (0.9, 0.1, 0.1), (0.1, 0.1, 0.9)


def cloth(colour=RED, y=0.0, inside_out=False):
    return RenderMesh(QUAD + np.float32([0, y, 0]), FACES[:, ::-1] if inside_out else FACES, colour, cloth=True)


def test_draws_the_mesh_in_its_colour_on_the_background():
    image = render([cloth()], "front", (60, 80), BOX)
    assert image.shape == (80, 60, 3) and image.dtype == np.uint8
    red, green, _ = image[40, 30].astype(int)
    assert red > 3 * green
    assert tuple(image[0, 0]) == tuple(round(255 * b) for b in BACKGROUND)


def test_the_nearer_mesh_hides_the_farther():
    front = render([cloth(BLUE, y=0.05), cloth(RED, y=-0.05)], "front", (60, 80), BOX)[40, 30].astype(int)
    back = render([cloth(BLUE, y=0.05), cloth(RED, y=-0.05)], "back", (60, 80), BOX)[40, 30].astype(int)
    assert front[0] > front[2] and back[2] > back[0]


def test_the_inner_side_of_cloth_is_darker():
    outer = render([cloth()], "front", (60, 80), BOX)[40, 30].astype(int)
    inner = render([cloth(inside_out=True)], "front", (60, 80), BOX)[40, 30].astype(int)
    assert inner.sum() < 0.85 * outer.sum()


def test_the_body_s_left_is_on_the_right_of_a_front_view_and_near_in_a_side_view():
    left, right = QUAD * 0.2 + np.float32([1, 0, 0]), QUAD * 0.2 + np.float32([-1, 0, 0])
    image = render([RenderMesh(left, FACES, RED), RenderMesh(right, FACES, BLUE)], "front", (80, 80), BOX).astype(int)
    reddish = np.argwhere(image[..., 0] > image[..., 2] + 50)
    bluish = np.argwhere(image[..., 2] > image[..., 0] + 50)
    assert reddish[:, 1].min() > bluish[:, 1].max()


@pytest.mark.parametrize("view", ["front", "three-quarter", "side", "back", "other side"])
def test_all_of_the_focus_box_is_in_the_picture(view):
    corners = np.array([[x, y, z] for x in BOX[:, 0] for y in BOX[:, 1] for z in BOX[:, 2]])
    hull = RenderMesh(
        corners,
        np.array(
            [
                [0, 1, 2],
                [1, 3, 2],
                [4, 6, 5],
                [5, 6, 7],
                [0, 4, 1],
                [1, 4, 5],
                [2, 3, 6],
                [3, 7, 6],
                [0, 2, 4],
                [2, 6, 4],
                [1, 5, 3],
                [3, 5, 7],
            ]
        ),
        RED,
    )
    image = render([hull], view, (60, 90), BOX)
    drawn = np.argwhere((image != 255).any(axis=2))
    assert drawn.min() >= 0 and (drawn.min(axis=0) > 0).any()
    edge = np.concatenate([image[0], image[-1], image[:, 0], image[:, -1]])
    assert (edge == 255).mean() > 0.45  # at most two opposite sides are touched


def test_the_same_picture_twice_and_a_kilometre_away():
    here = render([cloth()], "three-quarter", (60, 80), BOX)
    assert (here == render([cloth()], "three-quarter", (60, 80), BOX)).all()
    away = np.array([1024.0, 512.0, 0.0])
    moved = RenderMesh(QUAD + away.astype(np.float32), FACES, RED, cloth=True)
    there = render([moved], "three-quarter", (60, 80), BOX + away)
    assert np.abs(here.astype(int) - there).mean() < 0.5


def test_error_colours_have_a_fixed_scale():
    low, top, beyond = error_colours(np.array([0.0, 5.0, 50.0]))
    assert (top == beyond).all() and not np.allclose(low, top)


def test_bounds_of_two_clouds():
    box = bounds(np.zeros((2, 4, 3)), np.array([[1.0, 2.0, -3.0]]), margin=0.5)
    assert box.tolist() == [[-0.5, -0.5, -3.5], [1.5, 2.5, 0.5]]
