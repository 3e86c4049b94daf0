"""Other people's mesh files: read (`reading`), paired, placed, and written (`exporting`).

A file of each format's name reads and writes that format; all of them speak of a `MeshSequence`. What a file does not
say (units, up axis, frame rate) is inferred in `conventions`, and always printed.
"""
