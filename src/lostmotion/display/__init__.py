"""How results are shown to people, in Python, in a notebook, on the command line and in the report.

Nothing here knows what it shows: numbers, tables of cells, and the table of parameters of ``results.json``.
"""
