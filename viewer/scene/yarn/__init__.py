"""Yarns: curves that become plies and fibres, and the yarns of a weave."""
