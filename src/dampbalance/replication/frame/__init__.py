"""The base-driven frame of Marino and Cicirello (2023): friction force from records, checked on held-out cycles."""
