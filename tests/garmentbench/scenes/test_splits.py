"""What is trained on is not tested on: no scene, and no frame of a motion on a body that a training set holds."""

import pytest

from garmentbench.errors import UsageError
from garmentbench.scenes.scene import BASE, Scene
from garmentbench.scenes.training_sets import expanded, is_seen, title, training_set
from garmentbench.scenes.wardrobe import load_scene, scene_names, wardrobe

GARMENTS = ("tshirt", "bodysuit", "pleated_skirt", "dress", "over_skirt")
PAPER = ("tshirt", "bodysuit", "pleated_skirt")
SCENES = {name: load_scene(name) for name in scene_names()}
SETS = tuple(wardrobe().training_sets)


def frames(scene: Scene, count: int | None = None) -> set[int]:
    """Which frames of its motion a scene shows: all, or the first `count`."""
    start = round(scene.motion.start * scene.fps)
    return set(range(start, start + (count or scene.frames)))


def of(garment: str, **holds: str) -> list[Scene]:
    return [s for s in SCENES.values() if s.garment == garment and all(getattr(s, k) == v for k, v in holds.items())]


@pytest.mark.parametrize("garment", GARMENTS)
@pytest.mark.parametrize("chosen", SETS)
def test_no_frame_of_a_training_set_is_in_another_split(garment, chosen):
    """On bodies that are trained on, none is; on others the motion may be a seen one: there the body is new."""
    learnt = training_set(f"{garment}@{chosen}")
    assert {SCENES[name].split for name in learnt} == {"train"}
    bodies = wardrobe().training_sets[chosen].bodies
    for scene in of(garment):
        if scene.split == "train" or scene.body not in bodies:
            continue
        for name, count in learnt.items():
            seen = SCENES[name]
            if seen.motion.name == scene.motion.name:
                assert not frames(seen, count) & frames(scene), (name, scene.name)


@pytest.mark.parametrize("garment", GARMENTS)
def test_no_training_scene_shares_a_frame_with_a_test_or_validation_scene(garment):
    """... on any body that it is trained on; validation and tests share none either."""
    by_body = {body: [s for s in of(garment, body=body) if s.name in wardrobe().scenes()] for body in wardrobe().bodies}
    for scenes in (*by_body.values(), [s for s in of(garment, body=BASE) if s.name in wardrobe().scenes()]):
        for k, one in enumerate(scenes):
            for other in scenes[k + 1 :]:
                if one.motion.name == other.motion.name and one.split != other.split:
                    assert not frames(one) & frames(other), (one.name, other.name)


@pytest.mark.parametrize("garment", GARMENTS)
def test_the_dance_s_last_400_of_1500_frames_are_a_test_and_a_tenth_before_validates(garment):
    train, held, late = (SCENES[f"{garment}-dance-latin{part}"] for part in ("", "-held", "-late"))
    assert [s.split for s in (train, held, late)] == ["train", "validation", "test"]
    assert frames(train) | frames(held) | frames(late) == set(range(1500))
    assert len(frames(late)) == 400 and 10 * len(frames(held)) == len(frames(train) | frames(held))


def test_what_is_held_out_is_in_no_training_scene():
    for scene in SCENES.values():
        if scene.motion.name in ("dance-spin", "dance-bounce") or scene.body in ("heavy", "short"):
            assert scene.split == "test", scene.name
        if scene.motion.name == "armspace-60":
            assert scene.split == "validation"


def test_tests_are_long_enough():
    for name, scene in SCENES.items():
        if scene.split == "test" and scene.name in wardrobe().scenes():
            gait = scene.motion.name in ("armspace-90", "strut", "fast", "catwalk")
            assert scene.frames >= (150 if gait else 300), name
    assert {SCENES[f"{garment}-armspace-90"].frames for garment in PAPER} == {1150}


def test_the_inner_garment_of_a_later_part_is_in_the_same_part():
    outer = SCENES["over_skirt-dance-latin-late-slim"]
    assert outer.worn_over == SCENES["dress-dance-latin-late-slim"]


def test_varied_is_about_6000_frames_of_seven_motions_on_three_bodies():
    found = training_set("pleated_skirt@varied")
    assert len(found) == 21 and 5500 < sum(found.values()) < 6500
    assert training_set("tshirt@walk") == {"tshirt-armspace-75": 300}
    assert {SCENES[name].body for name in training_set("dress@walk-bodies")} == {"base", "slim", "tall"}


def test_words_become_scenes_and_scenes_the_name_of_their_set():
    names, counts = expanded(["sheet-stick-a", "dress@walk-dance"])
    assert names == ("sheet-stick-a", "dress-armspace-75", "dress-dance-latin")
    assert counts == {"dress-armspace-75": 300, "dress-dance-latin": 990}
    assert title(list(training_set("dress@varied"))) == "dress@varied"
    assert title(["dress-armspace-75", "dress-strut"]) == "dress-armspace-75+dress-strut"
    assert title(["dress-armspace-75"]) == "dress-armspace-75"


@pytest.mark.parametrize(
    ("motion", "body", "seen"),
    [
        ("dance-latin-late", "base", (True, True)),
        ("dance-latin-late", "heavy", (True, False)),
        ("armspace-90", "tall", (True, True)),
        ("dance-spin", "slim", (False, True)),
        ("dance-bounce", "short", (False, False)),
    ],
)
def test_kinds_and_bodies_that_varied_has_seen(motion, body, seen):
    assert is_seen(motion, body, "varied") == seen


@pytest.mark.parametrize(
    ("word", "complaint"),
    [
        ("dres@varied", "did you mean 'dress'"),
        ("dress@vried", "did you mean 'varied'"),
        ("@varied", "unknown garment ''"),
        ("sheet@varied", "unknown garment 'sheet'"),
    ],
)
def test_a_set_that_does_not_exist_is_one_line(word, complaint):
    with pytest.raises(UsageError) as error:
        training_set(word)
    assert complaint in str(error.value) and "\n" not in str(error.value)


def test_a_set_of_the_user_s_own_that_asks_for_too_much_is_told(home):
    (home / "wardrobe.toml").write_text(
        "[training_sets]\nlong = {frames = {strut = 999}}\nlost = {frames = {waltz = 9}}\n"
    )
    with pytest.raises(UsageError, match="999 frames of dress-strut, which has 180"):
        training_set("dress@long")
    with pytest.raises(UsageError, match="training set lost: unknown scene 'dress-waltz'"):
        training_set("dress@lost")
