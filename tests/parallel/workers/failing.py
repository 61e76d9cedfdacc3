"""doseki with a mistake in it: rank 1 throws after some messages."""

from __future__ import annotations

from doseki import cli
from doseki.parallel import transport

AFTER = 500


class Failing(transport.Transport):
    """Counts."""

    def finish(self) -> None:
        """Throws in the end."""
        self.count = getattr(self, "count", 0) + 1
        if self.rank == 1 and self.count == AFTER:
            raise RuntimeError("forced by a test")
        super().finish()


if __name__ == "__main__":
    from doseki.parallel import simulation

    simulation.Transport = Failing
    cli.main()
