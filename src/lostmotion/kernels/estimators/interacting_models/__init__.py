"""Interacting multiple models: free, and contact at either edge of the gap."""
