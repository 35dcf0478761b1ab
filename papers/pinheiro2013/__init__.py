"""Mixed H2/H-infinity attitude control of a microsatellite: pinheiro2013."""
