"""From a record to what every method starts from: band, gaps, components, spectra."""
