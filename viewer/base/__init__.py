"""What knows nothing of pictures: files, messages, progress, signals."""
