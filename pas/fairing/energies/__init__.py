"""Energies, one a file; `pas.fairing.energy` lists them."""
