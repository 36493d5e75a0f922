"""The texts for readers: the article, the page, the notebook, and where each number comes from."""
