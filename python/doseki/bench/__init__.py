"""How fast the schemes run on this machine, on one rank or several."""
