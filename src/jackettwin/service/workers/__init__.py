"""What runs in worker processes, and the cluster that runs it: plain values in, plain values out."""
