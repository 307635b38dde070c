"""What the sensors report of the boat's motion: antenna off midship, positions late, compass off."""

from swamp_rl.simulator.sensors.observe import CHANNELS, add_noise, observe, true_pose

__all__ = ["CHANNELS", "add_noise", "observe", "true_pose"]
