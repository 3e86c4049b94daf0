"""Other people's data: mesh sequences of garment and body in (`importing`) and out (`exporting`).

A file of each format's name reads and writes that format; all of them speak of a `MeshSequence`. What a file does not
say (units, up axis, frame rate) is inferred in `conventions`, and always printed.
"""
