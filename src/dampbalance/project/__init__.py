"""The configured case, files read and written, and words that several rooms share."""
