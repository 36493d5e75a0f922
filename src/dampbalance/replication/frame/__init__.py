"""The base-driven frame of Marino and Cicirello (2023): what an identification from its records says, shown on them."""
