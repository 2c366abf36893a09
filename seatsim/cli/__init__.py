"""The command line: commands, what they print and what they write. Nothing is computed here."""
