"""Physical constants in SI units, each with its source."""

import math

GRAVITY = 9.81
"""Acceleration of gravity g [m/s²], the value used by Elfouhaily et al. (1997)."""

VON_KARMAN = 0.41
"""Von Kármán constant κ [-], as in the drag law of Elfouhaily et al. (1997)."""

CAPILLARY_WAVENUMBER = 370.0
"""Wavenumber k_m [rad/m] where gravity and surface tension balance (Elfouhaily et al. 1997, eq. 24)."""

CAPILLARY_PHASE_SPEED = 0.23
"""Smallest phase speed c_m [m/s], reached at k_m (Elfouhaily et al. 1997)."""

AIR_VISCOSITY = 1.5e-5
"""Kinematic viscosity of air ν_a [m²/s] near 20 °C (Zhao & Toba 2001)."""

WATER_SURFACE_TENSION = 0.074
"""Surface tension of clean sea water γ_s [N/m] (Lamb 1932, §266)."""

WATER_DENSITY = 1025.0
"""Density of sea water ρ [kg/m³]."""

BREAKING_WAVENUMBER = math.pi * 256.0 / 11.0
"""Default breaking wavenumber k_b [rad/m]: π·256/11, what the default cascade resolves."""

KNOT = 1852.0 / 3600.0
"""One international knot [m/s]."""
