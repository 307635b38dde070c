"""The Gymnasium environments, single and batched; importing `swamp_rl` registers them."""
