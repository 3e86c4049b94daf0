"""Other people's files: meshes, motions, a doctor for meshes, and what makes sequences of them. The core never
imports this;
of the methods only the readers of their authors' files do.
"""
