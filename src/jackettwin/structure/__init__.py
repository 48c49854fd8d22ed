"""Steel: geometry to matrices."""
