"""Trust in the reference: finer steps, other starts, a finer mesh."""
