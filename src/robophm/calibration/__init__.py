"""Calibration of predictions against what happened: were the probabilities honest?"""
