"""How many threads everything that is timed may use: the bars are those of two cores."""

THREADS = 2
