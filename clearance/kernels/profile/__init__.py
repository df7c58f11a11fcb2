"""Swept profiles: what a moving surface leaves in a plane, and its outline."""
