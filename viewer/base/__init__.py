"""Utilities that do not depend on rendering: files, messages, progress, signals."""
