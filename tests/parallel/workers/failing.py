"""doseki with a mistake in it: rank 1 throws after some messages."""

from __future__ import annotations

from doseki.cli.main import main as cli
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
    from doseki.parallel import many_ranks, simulation

    many_ranks.PATIENCE = 1.0  # nobody else fails
    simulation.Transport = Failing
    cli()
