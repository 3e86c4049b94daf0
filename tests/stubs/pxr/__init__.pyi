"""OpenUSD, whose wheel has no types."""
