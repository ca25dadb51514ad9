"""The styles of pictures, one short file each."""
