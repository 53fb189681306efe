"""The commands of the command line: their options, and which jobs they do."""
