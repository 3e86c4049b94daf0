"""What a mesh's name says of it: a garment's or a body's."""

import re

WORDS = {
    "garment": r"garment|cloth|shirt|dress|skirt|top|suit|trouser|pant|jacket|coat|sheet|fabric",
    "body": r"body|avatar|human|skin|smpl|character|figure",
}


def role_of(name: str) -> str | None:
    """ "garment" or "body", as a mesh's name says; None where it says neither, or both."""
    found = [role for role, words in WORDS.items() if re.search(words, name, re.IGNORECASE)]
    return found[0] if len(found) == 1 else None


def are_two_things(names: tuple[str, ...]) -> bool:
    """Does one name say garment, and another body?"""
    return {"garment", "body"} <= {role_of(name) for name in names}
