"""What is timed, against what, with the answer checked: `make bench`, or `python -m benchmarks --quick`.

A definition (`definitions/`, one a file) names its input, checks the answers, and times us and its rivals (`rivals/`)
in turn in one run. A time that is too long is printed as missed; a wrong answer ends the run with exit code 1.
"""
