"""Which block of the rig an unexplained remainder lies in, and what is known of it."""
