"""One run of a study as a job of a cluster: the same as at home, without a parent to outlive.

python -m doseki.studies.runs.job DIR NAME
"""

from __future__ import annotations

import sys

from ...errors import DosekiError
from .one_run import carry_out


def main() -> None:
    """Entry point of the job."""
    try:
        carry_out(*sys.argv[1:])
    except DosekiError as error:
        print(error, file=sys.stderr)
        sys.exit(error.exit_code)


if __name__ == "__main__":
    main()
