"""The command line, of which rank 1 cannot import what it needs to join the others."""

from __future__ import annotations

import os
import sys

from doseki.cli.main import main

if os.environ["PMI_RANK"] == "1":
    sys.modules["doseki.driver.ranks"] = None  # type: ignore[assignment]
main()
