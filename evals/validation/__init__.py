"""The simulator against textbook problems, and the rules that no run may break."""
