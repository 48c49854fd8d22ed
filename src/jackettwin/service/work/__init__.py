"""What the server does with its queue of work: lease it, keep results, and draw the consequences."""
