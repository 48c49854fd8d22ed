"""Maximum-likelihood refinement of selected modes on the periodogram."""
