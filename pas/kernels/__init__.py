"""The compiled library: C sources, of which installing the package makes one shared library, and how it is called."""
