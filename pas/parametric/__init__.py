"""Parametric surfaces over Q, and all their parametric blends."""
