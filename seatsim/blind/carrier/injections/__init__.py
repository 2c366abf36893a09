"""Changes by the block that they act in; each is arithmetic on recorded channels, and knows no other."""
