"""Sealed cases on measured recordings: an effect put into real signals, or a mechanism taken out of a fitted nominal.

The truth is arithmetic on the recorded channels, so the background stays what was measured; nothing of it is shared
with the candidate effects. What is simulated, the nominal scenario alone, only says how large a change is.
"""
