"""The tests, with one thread of linear algebra: two workers share two cores, where idle threads spin.

Compiled modules are written to the disk, as by `make test`, whatever the shell says: every worker and every
command that a test starts would else compile all of them again.
"""

import os
import sys

os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
sys.dont_write_bytecode = False
