"""Which joint of a recording is which of ours: given, or guessed from the naming conventions in use."""

import difflib
import re
from collections import Counter
from dataclasses import dataclass

from garmentbench.errors import UserError, unknown_name

SIDED = ("clavicle", "upper_arm", "fore_arm", "hand", "thigh", "calf", "foot", "toes")
ROLES = ("pelvis", "chest", "neck", "head", *(f"{name}.{side}" for side in "LR" for name in SIDED))
OPTIONAL = ("neck", "head", "clavicle.L", "clavicle.R", "toes.L", "toes.R")

_BONES = ("pelvis", "chest", "neck", "head", *SIDED)
# What each convention calls our joints, in the order of _BONES, alternatives with |, the first that a recording has
# counts; small letters and digits only, without the side and without what all names of a file begin with.
_CONVENTIONS = {
    "Mixamo": "hips spine2 neck head shoulder arm forearm hand upleg leg foot toebase|toe",
    "CMU for MotionBuilder": "hips spine1 neck head shoulder arm forearm hand upleg leg foot toebase",
    "CMU for 3ds Max": "hips chest2|chest neck head collar shoulder elbow wrist hip knee ankle toe",
    "CMU for Daz": "hip chest neck head collar shldr forearm hand thigh shin foot footend",
    "CMU as captured": "root thorax lowerneck head clavicle humerus radius wrist|hand femur tibia foot toes",
    "SMPL": "pelvis spine3 neck head collar shoulder elbow wrist hip knee ankle foot",
    "3ds Max Biped": "pelvis spine3|spine2|spine1 neck head clavicle upperarm forearm hand thigh calf foot toe0",
    "Character Creator": "hip|pelvis spine02 necktwist01 head clavicle upperarm forearm hand thigh calf foot toebase",
    "Unreal": "pelvis spine03|spine3 neck01|neck head clavicle upperarm lowerarm hand thigh calf foot ball",
    "Unity": "hips upperchest|chest neck head shoulder upperarm lowerarm hand upperleg lowerleg foot toes|toe|toebase",
    "Blender": "hips|pelvis|spine chest|spine003|spine02 neck|spine004 head|spine006 shoulder upperarm forearm hand "
    "thigh shin foot toe",
    "Rokoko": "hips spine4|spine3|chest neck head shoulder arm forearm hand thigh shin foot toe|toebase",
    "Xsens": "pelvis|hips t8|chest neck head shoulder upperarm forearm hand upperleg lowerleg foot toe",
}
# Where a table's is not there.
_CHESTS = "chest upperchest spine4 spine3 spine03 spine2 spine02 spine1 spine01 torso thorax spine"
_SIDES = (  # how a name says its side; the rest of it is the bone
    (re.compile(r"^(left|right)(?![a-z])[ _.:-]*(.+)$|^(left|right)(.+)$", re.IGNORECASE)),
    (re.compile(r"^(.+?)[ _.:-]*(left|right)$", re.IGNORECASE)),
    (re.compile(r"^([lr])[ _.:-]+(.+)$", re.IGNORECASE)),
    (re.compile(r"^(.+?)[ _.:-]+([lr])$", re.IGNORECASE)),
    (re.compile(r"^([lr])([A-Z].*)$")),
    (re.compile(r"^(.*[a-z0-9])([LR])$")),
    (
        re.compile(
            r"^([lr])(shldr|forearm|hand|thigh|shin|foot.*|collar|clavicle|humerus|radius|wrist|femur|tibia|toes)$"
        )
    ),
)
_LISTED = 10  # joints named in a message


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
    guesses = {convention: _guess(names, table.split()) for convention, table in _CONVENTIONS.items()}
    convention = max(guesses, key=lambda c: len(guesses[c]))
    joints = {ours: theirs for ours, theirs in guesses[convention].items() if theirs not in given}
    joints |= {ours: theirs for theirs, ours in given.items()}
    if "chest" not in joints:
        joints |= _any_chest(names, set(joints.values()))
    missing = [role for role in ROLES if role not in joints and role not in OPTIONAL]
    if missing:
        raise UserError(_missing(where, names, joints, missing, convention))
    return NameMap(
        {role: joints[role] for role in ROLES if role in joints}, convention if len(joints) > len(given) else "given"
    )


def _missing(where: str, names: tuple[str, ...], joints: dict[str, str], missing: list[str], convention: str) -> str:
    """The complaint about joints without a counterpart, with a hint that may be right, and a few of the names left."""
    left = [n for n in names if n not in joints.values() and not n.endswith(" end")]
    side = missing[0].partition(".")[2]
    alike = [n for n in left if _parsed(n)[0] == side] or left
    bases = [_parsed(n)[1] for n in alike]
    near = difflib.get_close_matches(_plain(missing[0].partition(".")[0]), bases, n=1, cutoff=0.5)
    theirs = alike[bases.index(near[0])] if near else "NAME"
    listed = ", ".join(left[:_LISTED]) + (f" ... ({len(left)} in all)" if len(left) > _LISTED else "")
    most = f" (its names are most like those of {convention})" if joints else ""
    return (
        f"{where}: no joint found for {', '.join(missing)}{most}; name them with --map, e.g. --map "
        f"'{theirs}={missing[0]}'. Not yet used: {listed or 'none'}"
    )


def _guess(names: tuple[str, ...], table: list[str]) -> dict[str, str]:
    """Our joint -> the recording's, as far as a convention's names are there."""
    start = _common_start(names)
    known = {_parsed(name[len(start) :] or name): name for name in reversed(names)}
    known |= {_parsed(_without_namespace(name)): name for name in reversed(names)}
    found = {}
    for bone, words in zip(_BONES, table, strict=True):
        for side in "LR" if bone in SIDED else ("",):
            theirs = next((known[side, word] for word in words.split("|") if (side, word) in known), None)
            if theirs is not None:
                found[f"{bone}.{side}".rstrip(".")] = theirs
    return found


def _any_chest(names: tuple[str, ...], used: set[str]) -> dict[str, str]:
    """The highest joint of the spine as the chest, by its name; none where no name tells."""
    start = _common_start(names)
    known = {_parsed(name[len(start) :] or name): name for name in reversed(names) if name not in used}
    theirs = next((known["", word] for word in _CHESTS.split() if ("", word) in known), None)
    return {} if theirs is None else {"chest": theirs}


def _common_start(names: tuple[str, ...]) -> str:
    """What almost all names begin with, up to a separator: "CC_Base_", "Bip01 ", "mixamorig:"; "" for none."""
    joints = [n for n in names if not n.endswith(" end")]
    starts = Counter(n[: m.end()] for n in joints for m in re.finditer(r"[ _.:|-]+", n))
    common = [
        s
        for s, count in starts.items()
        if count >= 0.8 * len(joints) and s[:-1].lower() not in ("l", "r", "left", "right")
    ]
    return max(common, key=len, default="")


def _parsed(name: str) -> tuple[str, str]:
    """Side ("L", "R" or "") and bone of a name, in small letters and digits.

    >>> _parsed("LeftUpLeg"), _parsed("upper_arm.R"), _parsed("L_Thigh"), _parsed("lShldr"), _parsed("Spine2")
    (('L', 'upleg'), ('R', 'upperarm'), ('L', 'thigh'), ('L', 'shldr'), ('', 'spine2'))
    """
    for pattern in _SIDES:
        if match := pattern.match(name):
            one, other = (part for part in match.groups() if part is not None)
            side, bone = (one, other) if one.lower() in ("l", "r", "left", "right") else (other, one)
            if _plain(bone):
                return side[0].upper(), _plain(bone)
    return "", _plain(name)


def _without_namespace(name: str) -> str:
    """A name without "mixamorig:", "Armature|" and the like."""
    return re.sub(r"^(mixamorig\d*[:_]?|.*[:|])", "", name, flags=re.IGNORECASE) or name


def _plain(name: str) -> str:
    """Small letters and digits only."""
    return re.sub(r"[^a-z0-9]", "", name.lower())
