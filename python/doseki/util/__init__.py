"""What has nothing to do with particles: spelling, files, memory."""
