"""Learned forces: data sets, training and evaluation."""
