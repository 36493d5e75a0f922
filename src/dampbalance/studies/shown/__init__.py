"""What a study shows: figures, maps, summary and facts, from its table of cases."""
