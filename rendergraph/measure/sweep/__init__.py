"""Sweeps over parameters: what each setting costs in time and bytes, and what error it leaves."""
