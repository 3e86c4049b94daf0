"""Text: as programs write it, in UTF-8 or UTF-16, with and without byte order mark; and counts as people say them."""


def decoded(data: bytes) -> str:
    """The text; what is no text comes out as replacement characters.

    >>> decoded("v 1".encode("utf-16")), decoded("v 1".encode("utf-16-le")), decoded(b"\\xef\\xbb\\xbfv 1")
    ('v 1', 'v 1', 'v 1')
    """
    return data.decode(_encoding(data), errors="replace")


def as_utf8(data: bytes) -> bytes:
    """The same text in UTF-8, without byte order mark; what is UTF-8 already is not decoded."""
    if _encoding(data) == "utf-8-sig":
        return data.removeprefix(b"\xef\xbb\xbf")
    return decoded(data).encode()


def _encoding(data: bytes) -> str:
    if data.startswith((b"\xff\xfe", b"\xfe\xff")):
        return "utf-16"
    if len(data) > 3 and data[0] and data[2] and not data[1] and not data[3]:
        return "utf-16-le"
    if len(data) > 3 and data[1] and data[3] and not data[0] and not data[2]:
        return "utf-16-be"
    return "utf-8-sig"


def counted(count: int, one: str, many: str = "") -> str:
    """
    >>> counted(1, "edge"), counted(1200, "edge")
    ('1 edge', '1200 edges')
    """
    return f"{count} {one if count == 1 else many or one + 's'}"
