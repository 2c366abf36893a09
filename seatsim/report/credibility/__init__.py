"""How far the figures of a report may be trusted: evidence that was collected, and rules that make levels of it."""
