"""Stochastic subspace identification: poles of every model order, with their uncertainty."""
