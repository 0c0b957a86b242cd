"""Wind at 10 m, drag laws and fetch."""

from ._drag import AbstractDrag as AbstractDrag
from ._drag import ElfouhailyDrag as ElfouhailyDrag
from ._drag import WuDrag as WuDrag
from ._wind import Wind as Wind
from ._wind import direction_from_meteorological as direction_from_meteorological
from ._wind import inverse_wave_age_from_fetch as inverse_wave_age_from_fetch
from ._wind import knots as knots
