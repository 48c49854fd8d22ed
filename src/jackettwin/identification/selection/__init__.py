"""Selection of modes among poles, with a reason for each pole that is rejected."""
