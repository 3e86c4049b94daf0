"""Contacts that several particles share: cloth against itself, and the middles of faces and edges against the body.

Where cloth stays crossed with itself, `tangles` leads it out.
"""
