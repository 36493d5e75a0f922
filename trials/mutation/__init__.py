"""Mutation testing: would the tests notice an error in the method? (`make mutants`)"""
