"""Kinds of shapes, one short file each: how one is recorded, read, drawn and split into parts (`pas.shape.KINDS`)."""
