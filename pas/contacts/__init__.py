"""Contacts: the surfaces that a blend continues, one file a kind, and where they end on a partition."""
