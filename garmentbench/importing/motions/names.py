"""Which joint of a recording is which of ours: given, or guessed from the naming conventions in use."""

import re
from dataclasses import dataclass

from garmentbench.errors import UserError, unknown_name

SIDED = ("clavicle", "upper_arm", "fore_arm", "hand", "thigh", "calf", "foot", "toes")
ROLES = ("pelvis", "chest", "neck", "head", *(f"{name}.{side}" for side in "LR" for name in SIDED))
OPTIONAL = ("neck", "head", "clavicle.L", "clavicle.R", "toes.L", "toes.R")

# What each convention calls our joints; * is Left or Right, as the convention writes it, and the first name that a
# recording has counts.
_CONVENTIONS = {
    "Mixamo": (
        ("left", "right"),
        {
            "pelvis": "hips",
            "chest": "spine2",
            "neck": "neck",
            "head": "head",
            "clavicle": "*shoulder",
            "upper_arm": "*arm",
            "fore_arm": "*forearm",
            "hand": "*hand",
            "thigh": "*upleg",
            "calf": "*leg",
            "foot": "*foot",
            "toes": "*toebase *toe",
        },
    ),
    "CMU for MotionBuilder": (
        ("left", "right"),
        {
            "pelvis": "hips",
            "chest": "spine1",
            "neck": "neck",
            "head": "head",
            "clavicle": "*shoulder",
            "upper_arm": "*arm",
            "fore_arm": "*forearm",
            "hand": "*hand",
            "thigh": "*upleg",
            "calf": "*leg",
            "foot": "*foot",
            "toes": "*toebase",
        },
    ),
    "CMU for 3ds Max": (
        ("left", "right"),
        {
            "pelvis": "hips",
            "chest": "chest2 chest",
            "neck": "neck",
            "head": "head",
            "clavicle": "*collar",
            "upper_arm": "*shoulder",
            "fore_arm": "*elbow",
            "hand": "*wrist",
            "thigh": "*hip",
            "calf": "*knee",
            "foot": "*ankle",
            "toes": "*toe",
        },
    ),
    "CMU for Daz": (
        ("l", "r"),
        {
            "pelvis": "hip",
            "chest": "chest",
            "neck": "neck",
            "head": "head",
            "clavicle": "*collar",
            "upper_arm": "*shldr",
            "fore_arm": "*forearm",
            "hand": "*hand",
            "thigh": "*thigh",
            "calf": "*shin",
            "foot": "*foot",
            "toes": "*footend",
        },
    ),
    "CMU as captured": (
        ("l", "r"),
        {
            "pelvis": "root",
            "chest": "thorax",
            "neck": "lowerneck",
            "head": "head",
            "clavicle": "*clavicle",
            "upper_arm": "*humerus",
            "fore_arm": "*radius",
            "hand": "*wrist *hand",
            "thigh": "*femur",
            "calf": "*tibia",
            "foot": "*foot",
            "toes": "*toes",
        },
    ),
    "SMPL": (
        ("left", "right"),
        {
            "pelvis": "pelvis",
            "chest": "spine3",
            "neck": "neck",
            "head": "head",
            "clavicle": "*collar",
            "upper_arm": "*shoulder",
            "fore_arm": "*elbow",
            "hand": "*wrist",
            "thigh": "*hip",
            "calf": "*knee",
            "foot": "*ankle",
            "toes": "*foot",
        },
    ),
}


@dataclass(frozen=True)
class NameMap:
    """A map of names.

    Attributes:
        joints: The recording's joint for each of ours that it has.
        convention: Whose names they were guessed to be; "given" where none was guessed.
    """

    joints: dict[str, str]
    convention: str

    def lines(self) -> list[str]:
        """The map in words, left and right in one line."""
        out = []
        for role in ROLES:
            if role.endswith(".R"):
                continue
            both = [role, role[:-1] + "R"] if role.endswith(".L") else [role]
            theirs = " | ".join(self.joints.get(r, "none") for r in both)
            out.append(f"{role.removesuffix('.L'):<10} {theirs}")
        return out


def map_names(names: tuple[str, ...], given: dict[str, str], where: str) -> NameMap:
    """The map of a recording's joint names.

    Args:
        names: The recording's joints.
        given: The recording's name -> ours; these go before what is guessed.
        where: The file, for complaints.

    Raises:
        UsageError: A given name is not there, on either side.
        UserError: A joint that is needed has no counterpart.
    """
    for theirs, ours in given.items():
        if theirs not in names:
            raise unknown_name(f"joint of {where}", theirs, list(names))
        if ours not in ROLES:
            raise unknown_name("joint of the body", ours, list(ROLES))
    guesses = {convention: _guess(names, *table) for convention, table in _CONVENTIONS.items()}
    convention = max(guesses, key=lambda c: len(guesses[c]))
    joints = {ours: theirs for ours, theirs in guesses[convention].items() if theirs not in given}
    joints |= {ours: theirs for theirs, ours in given.items()}
    missing = [role for role in ROLES if role not in joints and role not in OPTIONAL]
    if missing:
        raise UserError(
            f"{where}: no joint found for {', '.join(missing)} (its names are most like those of {convention}); name them "
            f"with --map, e.g. --map {names[0]}={missing[0]}. It has {', '.join(n for n in names if not n.endswith(' end'))}"
        )
    return NameMap(
        {role: joints[role] for role in ROLES if role in joints}, convention if len(joints) > len(given) else "given"
    )


def _guess(names: tuple[str, ...], sides: tuple[str, str], table: dict[str, str]) -> dict[str, str]:
    """Our joint -> the recording's, as far as a convention's names are there."""
    plain = {_plain(name): name for name in reversed(names)}
    found = {}
    for role in ROLES:
        base, _, side = role.partition(".")
        word = sides["LR".index(side)] if side else ""
        for candidate in table[base].split():
            if candidate.replace("*", word) in plain:
                found[role] = plain[candidate.replace("*", word)]
                break
    return found


def _plain(name: str) -> str:
    """A name without its prefix ("mixamorig:", "Armature|"), in small letters and digits only."""
    return re.sub(r"[^a-z0-9]", "", re.sub(r"^(mixamorig\d*[:_]?|.*[:|])", "", name, flags=re.IGNORECASE).lower())
