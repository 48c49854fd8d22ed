from .structure_files import read_structure as read_structure, shipped_structures as shipped_structures
