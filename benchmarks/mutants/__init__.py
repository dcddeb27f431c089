"""Mutation testing: whether the tests notice that a line of model, fit or verdict is wrong."""
