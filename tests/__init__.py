"""The tests, with one thread of linear algebra: two workers share two cores, where idle threads spin."""

import os

os.environ.setdefault("OMP_NUM_THREADS", "1")
