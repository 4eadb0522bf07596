"""The package's own files, and how they are written whole or not at all."""
