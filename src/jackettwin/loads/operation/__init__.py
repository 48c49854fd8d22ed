"""Effects of an operating rotor on its tower: damping by wind speed, thrust and excitation."""
