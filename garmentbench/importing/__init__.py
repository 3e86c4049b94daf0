"""Other people's files: meshes, motions, and a doctor for meshes. The core never imports this."""
