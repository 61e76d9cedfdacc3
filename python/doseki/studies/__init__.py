"""Several runs side by side: the flume in both schemes, sensitivity to a parameter."""
