"""The boat's physics as plain scalar functions, each checked against its source's equation.

Every function takes numbers and `p`, one boat's parameter record (`swamp_rl.simulator.parameters`),
and is compiled by numba, so one source serves one boat and a batch. North-east-down frame, x to the bow,
y to starboard, headings clockwise from north; SI units and radians.
"""
