"""Modes of many records: tracking, fusion, setups, close pairs."""
