"""Train PPO of stable-baselines3 on the batched environment and evaluate its zip as `sb3:FILE`.

Prints the stored model's success in calm water, without the noise of exploration. The zip does not hold that
an action was held for several steps; the evaluation is told so by `hold`. Loading such a zip
unpickles it: name only zips that you trust.
"""

import json
from pathlib import Path

import torch
from gymnasium.vector import AutoresetMode
from stable_baselines3 import PPO
from stable_baselines3.common.logger import Logger
from swamp_rl.envs.batched import GatesVectorEnv
from swamp_rl.envs.sb3 import GatesVecEnv

import swamp_rl

DECISIONS, HOLD = 65_536, 5
torch.set_num_threads(1)  # the networks are small

boats = GatesVectorEnv(128, disturbances="calm", autoreset_mode=AutoresetMode.SAME_STEP)
env = GatesVecEnv(boats, hold=HOLD)  # an action is held for 5 steps of 0.1 s
model = PPO("MlpPolicy", env, n_steps=64, batch_size=1024, gamma=0.99, seed=0, device="cpu")
model.set_logger(Logger(None, []))  # its own makes a folder in the temporary directory
model.learn(DECISIONS)
model.save("example_ppo.zip")

folder = swamp_rl.evaluate(
    ["sb3:example_ppo.zip"],
    {"levels": ["calm"], "episodes": 50, "shown": 5},
    [f"pilots.example_ppo.options.hold={HOLD}"],
    out="results/example_sb3",
    experiment="camogli",
)
for name, pilot in json.loads(Path(folder, "results.json").read_text())["pilots"].items():
    print(f"{name}: {pilot['levels']['calm']['success_rate']:.0%} of 50 episodes")
