"""The command line `pas`.

`pas.cli.common.EXIT_CODES` says what the exit codes mean.  Errors go to stderr as one sentence; `--debug` shows the
traceback.
"""

from __future__ import annotations

import argparse
import io
import json
import sys
import traceback
import warnings
from collections.abc import Sequence

from pas.cli.common import DONE as DONE
from pas.cli.common import FAILED as FAILED
from pas.cli.common import INTERRUPTED as INTERRUPTED
from pas.cli.common import WRONG as WRONG
from pas.cli.common import tell, version_text
from pas.cli.parser import parser
from pas.errors import InputError, PasError
from pas.limits import limit


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command; returns the exit code."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):  # names may have letters that a terminal lacks
            stream.reconfigure(errors="backslashreplace")
    reader = parser()
    options = reader.parse_args(arguments)
    if options.version:
        print(version_text(options.verbose))
        return DONE
    if options.command is None:
        reader.print_help()
        return WRONG
    try:
        with warnings.catch_warnings(), limit(options.seconds, tell):
            warnings.showwarning = lambda message, *_: print(f"pas: {message}", file=sys.stderr)
            outcome = options.run(options)
            print(json.dumps(outcome.record, indent=1) if options.json else outcome.text)
            return int(outcome.code)
    except KeyboardInterrupt:
        print("pas: interrupted; nothing was left half-written", file=sys.stderr)
        return INTERRUPTED
    except (InputError, ValueError, TypeError, FileNotFoundError, PermissionError, IsADirectoryError) as error:
        return _fail(options, error, WRONG)
    except (PasError, OSError) as error:
        return _fail(options, error, FAILED)


def _fail(options: argparse.Namespace, error: Exception, code: int) -> int:
    if options.debug:
        traceback.print_exc()
    text = f"{error.strerror}: {error.filename}" if isinstance(error, OSError) and error.strerror else str(error)
    line = " ".join(text.split())  # what it quotes (polynomials, say) may be long, and is cut in the middle then
    line = line if len(line) <= 600 else f"{line[:300]} ... {line[-300:]}"
    print(f"pas: {line}", file=sys.stderr)
    return code
