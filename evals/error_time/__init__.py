"""Error against run time: every method and the simulator as curves of what they can be given."""
