"""Stress and life from records, through the updated twin."""
