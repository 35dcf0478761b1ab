"""Li 2021: non-fragile robust attitude control of a flexible microsatellite by dynamic output feedback."""
