"""Choosing scenes by what is typed: names, patterns, and what they hold."""

from collections.abc import Sequence
from fnmatch import fnmatchcase
from pathlib import Path

from garmentbench.errors import UsageError, unknown_name
from garmentbench.scenes.scene import Scene
from garmentbench.scenes.wardrobe import load_scene, scene_file, scene_names

KEYS = ("garment", "body", "motion", "split")


def is_choice(word: str) -> bool:
    """Does a word stand for any number of scenes (a pattern or a filter), not for one?"""
    return any(c in word for c in "*?[=")


def chosen_files(words: Sequence[str]) -> dict[str, Path]:
    """The files of the scenes that words stand for, by the scenes' names, of those that have one."""
    names = [name for word in words if "=" not in word for name in _named(word)]
    return {Path(name).stem: file for name in names if (file := scene_file(name)) is not None}


def choose_scenes(words: Sequence[str]) -> list[Scene]:
    """The scenes that words stand for: those of any name, path of a TOML file or pattern (all, if there is none), as
    far as every filter key=value fits.

    >>> [scene.name for scene in choose_scenes(["sheet-*", "split=train"])]
    ['sheet-stick-a']

    Raises `UsageError` for a word that fits no scene.
    """
    filters = [word.split("=", 1) for word in words if "=" in word]
    for key, _ in filters:
        if key not in KEYS:
            raise unknown_name("filter", key, list(KEYS))
    named = [name for word in words if "=" not in word for name in _named(word)]
    if not any("=" not in word for word in words):
        named = scene_names()
    chosen = [scene for scene in map(load_scene, dict.fromkeys(named)) if _fits(scene, filters)]
    if not chosen:
        raise UsageError(f"no scene fits {' '.join(words)}; `garmentbench scenes` lists them all")
    return chosen


def _named(word: str) -> list[str]:
    if not is_choice(word):
        return [word]
    found = [name for name in scene_names() if fnmatchcase(name, word)]
    if not found:
        raise UsageError(f"no scene fits '{word}'; `garmentbench scenes` lists them all")
    return found


def _fits(scene: Scene, filters: list[list[str]]) -> bool:
    holds = {"garment": scene.garment, "body": scene.body, "motion": scene.motion.name, "split": scene.split}
    return all(fnmatchcase(holds[key], value) for key, value in filters)
