"""Looking at roll-outs: pictures of meshes, and Rerun recordings of body, reference and prediction side by side."""
