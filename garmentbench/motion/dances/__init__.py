"""The dances."""
