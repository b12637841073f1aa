"""Predictions against what happened: were the probabilities honest?"""
