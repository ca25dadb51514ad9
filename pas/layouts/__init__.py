"""Layouts of the directions around a node, one file a kind, and the regions built on them."""
