"""What people are told of findings, by whom they want to be told: rules, channels, and what is on its way."""
