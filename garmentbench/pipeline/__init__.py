"""Train a method, roll it out, score it; finished work is reused.

Together with the command line this is the outermost shell: methods are reached from here. Only `choice` takes names.
"""
