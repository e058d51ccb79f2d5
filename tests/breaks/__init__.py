"""Faults made on purpose, and the tests at every change that must find them."""
