"""Model criticism: the difference between a simulated boat and measured runs, the effects that explain it,
and the reduction of the prediction error when they are added.
"""
