"""Kinds of contacts beside pipes and cones, one short file each."""
