"""Files and runs on disk: written whole or not at all, locked, fingerprinted, resumed."""
