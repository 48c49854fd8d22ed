"""Many records identified: grouped, fused, written."""
