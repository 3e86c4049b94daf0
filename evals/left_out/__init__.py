"""What a scene does not need is not built: what that saves, and what it costs, measured both ways."""
