"""Constraints: conditions that a curve keeps while tools edit it (none are built in yet)."""

__all__: list[str] = []
