"""Jobs done by worker processes of this machine or of a cluster."""

from swamp_rl.workers.pool import Ended, Pool, answers, completed, open_pool

__all__ = ["Ended", "Pool", "answers", "completed", "open_pool"]
