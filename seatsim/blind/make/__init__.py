"""Drawing of cases and writing of their recordings; equations of the rig belong in `truth`, verdicts in `score`."""
