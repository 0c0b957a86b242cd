"""Failures that carry advice."""


class FitError(RuntimeError):
    """A fit that gave no answer: what happened, the likely cause, what to try.

    **Arguments:** `what`, `cause`, `advice`: three parts of the one sentence that a user reads.
    """

    def __init__(self, what: str, cause: str, advice: str) -> None:
        super().__init__(f"{what}. Likely cause: {cause}. Try: {advice}.")
        self.what = what
        self.cause = cause
        self.advice = advice
