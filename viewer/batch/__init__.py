"""Pictures of many models: in this process, in others beside it, or on a cluster."""
