"""Preparation of a record for all methods: band, gaps, components, spectra."""
