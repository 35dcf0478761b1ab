"""Speed as ratios against baselines measured in the same run; misses are reported, nothing depends on them."""
