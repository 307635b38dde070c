"""Constants of nature and of statistics, and units of others, in SI."""

GRAVITY = 9.81  # m/s2
KNOT = 1852.0 / 3600.0  # m/s
FOOT = 0.3048  # m
POUND = 0.45359237  # kg
DAY = 86_400.0  # s
Z95 = 1.959963984540054  # standard deviations of a normal distribution, within which 95 % lie
SWAMP_LENGTH = 1.24  # m; gains and habits chosen for SWAMP serve boats of other lengths by Froude's law
FASTEST = 3.0  # Froude number up to which a top speed is sought
SHORTEST_BOAT, LONGEST_BOAT = 0.01, 1000.0  # m
SLOWEST_BOAT, FASTEST_BOAT = 0.01, 100.0  # m/s
LIGHTEST_BOAT, HEAVIEST_BOAT = 1e-3, 1e9  # kg
LEAST_THROTTLE = 0.01  # of a manoeuvre: with less the boat does not move
LIGHTEST_WATER, HEAVIEST_WATER = 900.0, 1300.0  # kg/m3
FASTEST_WATER = 20.0  # m/s, of any current
FASTEST_AIR = 200.0  # m/s, of any wind
