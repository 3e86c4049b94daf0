"""The stress ladder: rungs that each leave what the methods were trained on in one way, climbed from several starts."""
