"""Newton, whose types say that what is there once a model is finished may be None."""

from typing import Any

def __getattr__(name: str) -> Any: ...
