"""Files that the commands write and tables that they print, one module a kind of result; nothing is computed here."""
