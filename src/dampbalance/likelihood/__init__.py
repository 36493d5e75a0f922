"""The yardstick: the maximum-likelihood fit of whole records, and how much information they hold."""
