"""What the model itself may miss: tolerances of drawings and sea, common to all modes, and a remainder."""
