"""A shipped scenario as a running simulation, without a record."""

from doseki.validate.running import Running as Case

__all__ = ["Case"]
