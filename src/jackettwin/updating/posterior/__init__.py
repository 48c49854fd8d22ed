"""Posterior of the parameters, its evidence and identifiability."""
