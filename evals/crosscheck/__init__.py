"""The reference against an independent engine: the same cloth, start and body in Newton's VBD solver (optional extra)."""
