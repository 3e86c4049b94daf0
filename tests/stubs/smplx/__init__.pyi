"""Optional, and not installed for the type check."""

from typing import Any

def __getattr__(name: str) -> Any: ...
