"""What a scene asks for: will the pose alone do, does it take dynamics, how well can it be predicted at all."""
