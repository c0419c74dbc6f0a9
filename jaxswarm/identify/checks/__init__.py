"""What a log cannot be: wrong signs, units and channels, found by rough fits before anything is identified."""
