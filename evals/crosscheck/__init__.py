"""The reference against an independent engine.

The same cloth, start and body in Newton's VBD solver (optional extra).
"""
