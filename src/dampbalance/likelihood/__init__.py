"""How much information whole records hold: the bound for every estimate from them."""
