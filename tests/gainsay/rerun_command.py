"""Rerun's own command, as an independent reader of what the library writes."""

import subprocess

from gainsay.logs.quiet import quiet, rerun_binary


def call(*arguments: str) -> str:
    """Run the command to its end and return what it printed."""
    with quiet() as environment:
        done = subprocess.run(
            [rerun_binary(), *arguments], env=environment, capture_output=True, text=True, check=True, timeout=120
        )
    return done.stdout
