"""Errors that are the user's to solve: one sentence, exit code 2, no traceback."""

import difflib
from collections.abc import Iterable


class Interrupted(Exception):
    """Ctrl-C, with a sentence that says what is kept; the command line's parser swallows a `KeyboardInterrupt`."""


class UserError(Exception):
    """What is wrong, where it stands, what to do: one sentence each, and nothing else is shown."""


def nearest(word: str, known: Iterable[str]) -> str | None:
    """The known word that the user most likely meant, if one is near."""
    found = difflib.get_close_matches(word, list(known), n=1, cutoff=0.5)
    return found[0] if found else None
