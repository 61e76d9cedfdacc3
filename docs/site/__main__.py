"""`./doseki docs`: builds the documentation into build/site.

Every warning of the build is an error: a link that leads nowhere, an anchor that is not there, a
page that no menu shows.
"""

from __future__ import annotations

import argparse
import functools
import http.server
import shutil
import sys
from pathlib import Path

from sphinx.cmd.build import build_main

from .staging import stage

ROOT = Path(__file__).resolve().parents[2]
WORK, SITE = ROOT / "build" / "site-work", ROOT / "build" / "site"


def build(site: Path = SITE, work: Path = WORK) -> int:
    """Build the site; the exit code of Sphinx, 0 where nothing is wrong."""
    stage(ROOT, work / "pages")
    settings = ["-q", "-W", "--keep-going", "-c", str(Path(__file__).parent)]
    settings += ["-d", str(work / "read")]
    code = build_main(["-b", "html", *settings, str(work / "pages"), str(site)])
    if code:  # what is wrong is said again the next time
        shutil.rmtree(work / "read", ignore_errors=True)
    return code


def serve(site: Path, port: int) -> None:
    """Show the site to browsers of this machine until Ctrl-C."""
    handler = functools.partial(http.server.SimpleHTTPRequestHandler, directory=str(site))
    with http.server.ThreadingHTTPServer(("127.0.0.1", port), handler) as server:
        print(f"the documentation: http://127.0.0.1:{port}/ (Ctrl-C ends)")
        try:
            server.serve_forever()
        except KeyboardInterrupt:
            print()


def main(arguments: list[str] | None = None) -> int:
    """Entry point."""
    parser = argparse.ArgumentParser(prog="doseki docs", description="Build the documentation.")
    parser.add_argument("-o", "--output", type=Path, default=SITE, help="folder of the site")
    parser.add_argument("--serve", action="store_true", help="show it to browsers of this machine")
    parser.add_argument("--port", type=int, default=8000, help="where to (8000)")
    options = parser.parse_args(arguments)
    if code := build(site=options.output):
        return code
    print(f"{options.output / 'index.html'}: open it in a browser, no network is needed")
    if options.serve:
        serve(options.output, options.port)
    return 0


if __name__ == "__main__":
    sys.exit(main())
