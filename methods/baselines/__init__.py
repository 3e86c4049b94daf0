"""Simple methods that every learned one is compared with."""
