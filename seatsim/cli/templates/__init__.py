"""What `seatsim new` writes: files that work as they stand, with comments on what to change. Nothing imports them."""
