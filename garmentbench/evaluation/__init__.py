"""Rolling a method out, scoring it, and checking that it keeps its contract."""
