"""The figures and tables of the paper (Shechter et al. 2022), each drawn from a run of this package."""
