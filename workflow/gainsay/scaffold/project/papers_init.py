"""One folder a paper: the data it prints and the physics only it has."""
