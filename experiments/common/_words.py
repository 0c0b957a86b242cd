"""Phrases that several experiments say alike."""


def low_pass(breaking_wavenumber: float | None) -> str:
    """Which waves the foam sees, for titles and tables."""
    return "no low-pass" if breaking_wavenumber is None else f"k_b = {breaking_wavenumber:.4g} rad/m"
