"""The commands that this package adds to `neuralmls`: a file each, named in its entry points."""
