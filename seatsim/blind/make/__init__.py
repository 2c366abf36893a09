"""Drawing of cases and writing of their recordings."""
