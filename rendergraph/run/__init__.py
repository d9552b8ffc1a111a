"""Runs a plan on a device, frame after frame, and writes what it produced."""
