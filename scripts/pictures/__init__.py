"""The pictures of the documentation, each drawn by the program itself: ``make pictures``."""
