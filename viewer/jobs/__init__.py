"""The commands of the command line as plain functions: options, render requests, picture makers, info, doctor."""
