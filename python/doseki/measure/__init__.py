"""From a record to numbers: windows, the flow over time, a census of grains."""
