"""The paper's user study as an instrument: a page that collects choices, and the table of what was chosen.

`cases` says which deformations are judged, `build` makes the page, `report` reads what participants saved.
"""
