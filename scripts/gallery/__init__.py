"""The figures of the thesis, drawn from our own computations with the code the report uses."""
