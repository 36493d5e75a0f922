"""Mutation testing: would the tests notice an error in the package? (`make mutants`)"""
