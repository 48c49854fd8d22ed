"""Wind, blades and rotor."""
