"""What the command line does, as plain calls: options, render requests, picture makers, info, doctor."""
