"""The server's queue of work: leases, results and their consequences."""
