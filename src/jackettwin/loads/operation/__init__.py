"""What a rotor at work does to its tower: damping by wind speed, thrust, and what it shakes it with."""
